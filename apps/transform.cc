// scancal transform DATASET --calibration FILE --out FILE
#include <gflags/gflags.h>
#include <cstdio>
#include "apps/calibrate.h"
#include "apps/command.h"
#include "io/points.h"

DECLARE_string(out);
DEFINE_string(calibration, "calibration.json", "result of scancal refine");
DEFINE_bool(u, false, "with each point its standard uncertainty u_x, u_y, u_z, as of the calibration");
DEFINE_bool(covariance, false, "with each point the six elements of its covariance, xx, xy, xz, yy, yz, zz");

namespace scancal {
namespace {

Result<int> Transformed(const std::vector<std::string>& arguments) {
  SCANCAL_ASSIGN_OR_RETURN(const Dataset dataset, ReadOnlyArgument(arguments));
  SCANCAL_ASSIGN_OR_RETURN(const ScannerKind* kind, FindScannerKind(dataset));
  SCANCAL_ASSIGN_OR_RETURN(const Rechecked calibration, RecheckForUse(FLAGS_calibration));
  SCANCAL_RETURN_IF_ERROR(CheckSameInstrument(calibration, dataset));
  if ((FLAGS_u || FLAGS_covariance) && !kind->transforms_with_u)
    return Error{std::string("--u: the model ") + kind->name +
                 " gives none with a cloud; propagate gives it for points"};
  SCANCAL_ASSIGN_OR_RETURN(const std::unique_ptr<PointCloudWriter> cloud,
                           CreatePointCloud(FLAGS_out, {FLAGS_u, FLAGS_covariance}));
  SCANCAL_ASSIGN_OR_RETURN(const int64_t points, kind->transform(dataset, calibration.found, cloud.get()));
  SCANCAL_RETURN_IF_ERROR(cloud->Commit());
  std::printf("wrote %lld points in mm to %s\n", static_cast<long long>(points), FLAGS_out.c_str());
  return WarnOf(calibration, FLAGS_calibration);
}

int RunTransform(const std::vector<std::string>& arguments) {
  if (FLAGS_out.empty()) return Complain("--out: expected a file name that ends in .ply, .csv or .npy");
  const Result<int> code = Transformed(arguments);
  return code.ok() ? *code : Complain(code.error().message);
}

}  // namespace

const Command kTransformCommand = {
    "transform",
    "DATASET",
    "the scans as one point cloud in the table frame: .ply, .csv or .npy by the name of --out",
    {{"calibration"},
     {"out", "point cloud to write: a name that ends in .ply, .csv or .npy"},
     {"u"},
     {"covariance"},
     {"unreliable"},
     {"key"}},
    &RunTransform};

}  // namespace scancal
