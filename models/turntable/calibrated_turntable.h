// A turntable as its calibration describes it.
#pragma once
#include <vector>
#include "io/result.h"
#include "models/turntable/volume.h"
#include "solver/calibration.h"
#include "solver/results.h"

namespace scancal {

class CalibratedTurntable {
 public:
  // An Error without M and N. Quantities that the calibration does not name, as in old files, are zero.
  static Result<CalibratedTurntable> From(const Calibration& calibration);

  const turntable::System& system() const { return system_; }
  const ScannedVolume& volume() const { return volume_; }

 private:
  CalibratedTurntable(const turntable::System& system, const ScannedVolume& volume)
      : system_(system), volume_(volume) {}

  turntable::System system_;
  ScannedVolume volume_;
};

// Points with what is known of the system: estimated, or considered and therefore in the estimates, too. The mount's
// temperature (expansion) in use is another than that of the calibration, as uncertain. Errors of the reading itself,
// one a point (noise) or one a profile (encoder_jitter), are not in it.
class PointUncertainty {
 public:
  // An Error without volume or budget: older versions did not write them.
  static Result<PointUncertainty> From(const Calibration& calibration);
  const CalibratedTurntable& turntable() const { return turntable_; }
  PropagatedPoint At(double alpha, double y, double z) const;
  // Two readings of one system, whose errors they share. Where the points coincide: in the direction known least.
  PropagatedDistance Between(const PropagatedPoint& a, const PropagatedPoint& b) const;

 private:
  PointUncertainty(CalibratedTurntable turntable, JointCovariance joint)
      : turntable_(std::move(turntable)), joint_(std::move(joint)) {}
  // Derivatives of a point by joint_.names.
  Eigen::MatrixXd ByJoint(const turntable::System::Derivatives& of) const;

  CalibratedTurntable turntable_;
  JointCovariance joint_;
  std::vector<int> index_;  // in Turntable, of each of joint_.names
};

}  // namespace scancal
