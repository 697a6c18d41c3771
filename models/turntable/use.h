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

// u of a line of the budget, in its unit; 0 without one.
double UOfSource(const Calibration& calibration, const std::string& source);

// One turn more or less is the same place: the angle (rad) in the volume, or else the nearest to its middle.
double WholeTurnsAway(const ScannedVolume& volume, double alpha);

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
  // At(...).uncertainty.covariance alone, mm^2: for many points.
  Eigen::Matrix3d CovarianceAt(double alpha, double y, double z) const;
  // Of measurands whose derivatives by the quantities of the system, Model::Index, are given, one row each. scale: not
  // null: out of it comes their derivative by scale_y, and it is left out of the covariance: directly, and through the
  // estimates, which follow it. Where it was not considered M and N follow as planes let them, M scale_y and N scale_y.
  MeasurandUncertainty Of(const Eigen::Ref<const Eigen::MatrixXd>& by_system, Eigen::VectorXd* scale = nullptr) const;
  // Two readings of one system, whose errors they share. Where the points coincide: in the direction known least.
  PropagatedDistance Between(const PropagatedPoint& a, const PropagatedPoint& b) const;

 private:
  PointUncertainty(const System& system, const ScannedVolume& volume, JointCovariance joint)
      : system_(system), volume_(volume), joint_(std::move(joint)) {}
  // Derivatives of a point by joint_.names.
  Eigen::MatrixXd ByJoint(const Eigen::Ref<const Eigen::MatrixXd>& by_system) const;

  System system_;
  ScannedVolume volume_;
  JointCovariance joint_;
  std::vector<int> index_;  // in Model, of each of joint_.names
};

// The model's part of ScannerKind.
Result<int64_t> Transform(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud);
Result<Propagation> Propagate(const Calibration& calibration, const PointRequest& points, bool distances);

}  // namespace scancal::turntable
