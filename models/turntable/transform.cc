// The scans of a data set as one point cloud in the table frame.
#include <set>
#include "io/progress.h"
#include "models/turntable/calibrated_turntable.h"
#include "models/turntable/raw_profiles.h"
#include "models/turntable/turntable_scanner.h"

namespace scancal {

Result<int64_t> TransformTurntable(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud) {
  SCANCAL_ASSIGN_OR_RETURN(const CalibratedTurntable turntable, CalibratedTurntable::From(calibration));
  Turntable model(Turntable::Residuals::kDepth);
  SCANCAL_ASSIGN_OR_RETURN(const TurntableDeclaration declaration, DeclareTurntable(dataset, &model));
  std::set<std::filesystem::path> done;  // several targets may be regions of one scan, which is written whole, once
  int64_t points = 0;
  int number = 0;
  for (ScanDeclaration scan : declaration.scans) {
    if (!done.insert(scan.format.path.lexically_normal()).second) continue;
    scan.format.lines.reset();
    SCANCAL_ASSIGN_OR_RETURN(const auto reader, ScanReader::Open(scan.format));
    Progress progress("transforming " + scan.scan);
    ScanBatch batch;
    std::vector<std::array<double, 3>> transformed;
    for (;;) {
      SCANCAL_ASSIGN_OR_RETURN(const bool more, reader->Next(&batch));
      if (!more) break;
      const SensorColumns sensor = ToSensor(declaration.sense, batch);
      transformed.clear();
      for (size_t i = 0; i < batch.size(); ++i) {
        const Eigen::Vector3d p = turntable.system().Point(sensor.alpha[i], sensor.y[i], sensor.z[i]);
        transformed.push_back({p.x(), p.y(), p.z()});
      }
      SCANCAL_RETURN_IF_ERROR(cloud->Write(transformed, number));
      points += static_cast<int64_t>(transformed.size());
      progress.Show(static_cast<double>(reader->bytes_read()) /
                    static_cast<double>(std::max<int64_t>(1, reader->bytes_total())));
    }
    ++number;
  }
  return points;
}

}  // namespace scancal
