// A calibrated turntable in use: points, what they are worth, whole scans.
#pragma once
#include <optional>
#include <string>
#include <vector>
#include "io/dataset.h"
#include "io/points.h"
#include "io/result.h"
#include "models/turntable/compress.h"
#include "solver/calibration.h"
#include "solver/results.h"

namespace scancal::turntable {

// What a calibration found. An Error without M and N. Quantities that it does not name, as in old files, are zero.
Result<System> SystemOf(const Calibration& calibration);

// Of the readings in a calibration's volume; old files have none.
std::optional<ScannedVolume> VolumeOf(const Calibration& calibration);

// Calibration::volume: the points of a grid of readings over all scans with their expanded uncertainties, see
// PointUncertainty. Everything else that they come from must be in place.
void AddVolume(const std::vector<Placement>& placements, Calibration* calibration);

// Points with what is known of the system: estimated, or considered and therefore in the estimates, too. The mount's
// temperature (expansion) in use is another than that of the calibration, as uncertain. Errors of the reading itself,
// one a point (noise) or one a profile (encoder_jitter), are not in it.
class PointUncertainty {
 public:
  // An Error without volume or budget: older versions did not write them.
  static Result<PointUncertainty> From(const Calibration& calibration);
  const System& system() const { return system_; }
  const ScannedVolume& volume() const { return volume_; }
  PropagatedPoint At(double alpha, double y, double z) const;
  // Two readings of one system, whose errors they share. Where the points coincide: in the direction known least.
  PropagatedDistance Between(const PropagatedPoint& a, const PropagatedPoint& b) const;

 private:
  PointUncertainty(const System& system, const ScannedVolume& volume, JointCovariance joint)
      : system_(system), volume_(volume), joint_(std::move(joint)) {}
  // Derivatives of a point by joint_.names.
  Eigen::MatrixXd ByJoint(const System::Derivatives& of) const;

  System system_;
  ScannedVolume volume_;
  JointCovariance joint_;
  std::vector<int> index_;  // in Model, of each of joint_.names
};

// The model's part of ScannerKind.
Result<int64_t> Transform(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud);
Result<Propagation> Propagate(const Calibration& calibration, const PointRequest& points, bool distances);

}  // namespace scancal::turntable
