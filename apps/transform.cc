// scancal transform DATASET --calibration FILE --out FILE
#include <gflags/gflags.h>
#include <cstdio>
#include "apps/calibrate.h"
#include "apps/command.h"
#include "io/points.h"
#include "report/calibration_json.h"

DECLARE_string(out);
DEFINE_string(calibration, "calibration.json", "result of scancal refine");

namespace scancal {
namespace {

Result<int64_t> Transformed(const std::vector<std::string>& arguments) {
  SCANCAL_ASSIGN_OR_RETURN(const Dataset dataset, ReadOnlyArgument(arguments));
  SCANCAL_ASSIGN_OR_RETURN(const ScannerKind* kind, FindScannerKind(dataset));
  SCANCAL_ASSIGN_OR_RETURN(const Calibration calibration, ReadCalibration(FLAGS_calibration));
  if (calibration.model != dataset.model)
    return Error{"the calibration is of model \"" + calibration.model + "\", the data set of \"" + dataset.model +
                 "\""};
  if (!calibration.ok())
    std::fprintf(stderr, "scancal: warning: %s has status unreliable\n", FLAGS_calibration.c_str());
  SCANCAL_ASSIGN_OR_RETURN(const std::unique_ptr<PointCloudWriter> cloud, CreatePointCloud(FLAGS_out));
  SCANCAL_ASSIGN_OR_RETURN(const int64_t points, kind->transform(dataset, calibration, cloud.get()));
  SCANCAL_RETURN_IF_ERROR(cloud->Commit());
  return points;
}

int RunTransform(const std::vector<std::string>& arguments) {
  if (FLAGS_out.empty()) return Complain("--out: expected a file name that ends in .ply, .csv or .npy");
  const Result<int64_t> points = Transformed(arguments);
  if (!points.ok()) return Complain(points.error().message);
  std::printf("wrote %lld points in mm to %s\n", static_cast<long long>(*points), FLAGS_out.c_str());
  return kTrusted;
}

}  // namespace

const Command kTransformCommand = {
    "transform",
    "DATASET",
    "the scans as one point cloud in the table frame: .ply, .csv or .npy by the name of --out",
    {{"calibration"}, {"out", "point cloud to write: a name that ends in .ply, .csv or .npy"}},
    &RunTransform};

}  // namespace scancal
