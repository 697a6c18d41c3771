#include "models/turntable/calibrated_turntable.h"
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace scancal {
namespace {

const Quantities& AllQuantities() {
  static const Turntable turntable(Turntable::Residuals::kDepth);
  return turntable.quantities();
}

}  // namespace

Result<CalibratedTurntable> CalibratedTurntable::From(const Calibration& calibration) {
  turntable::System system;
  for (size_t k = 0; k < system.q.size(); ++k) {
    const std::string& name = AllQuantities()[k].name;
    if (const Parameter* parameter = calibration.Find(name)) {
      system[k] = parameter->value;
    } else if (k == Turntable::kM || k == Turntable::kN) {
      return Error{"the calibration has no parameter " + name + ", expected the result of a turntable"};
    }
  }
  const std::optional<ScannedVolume> volume = VolumeOf(calibration);
  if (system[Turntable::kLinearity] != 0 && !volume)
    return Error{"the calibration has a linearity, but no volume to tell the range of depths; refine the data again"};
  if (volume) system.depths = volume->y;
  return CalibratedTurntable(system, volume.value_or(ScannedVolume()));
}

Result<PointUncertainty> PointUncertainty::From(const Calibration& calibration) {
  SCANCAL_ASSIGN_OR_RETURN(CalibratedTurntable turntable, CalibratedTurntable::From(calibration));
  if (!VolumeOf(calibration))
    return Error{"the calibration has no volume, so an older version wrote it; refine the data again"};
  PointUncertainty result(std::move(turntable), JointOf(calibration));
  result.joint_.Renew(AllQuantities()[Turntable::kExpansion].name);
  const std::vector<std::string>& names = result.joint_.names;
  for (const std::string& name : names) result.index_.push_back(Find(AllQuantities(), name));
  for (int k = 0; k < Turntable::kNormal1; ++k) {
    const Parameter* parameter = calibration.Find(AllQuantities()[k].name);
    if (parameter && parameter->u > 0 && std::find(names.begin(), names.end(), parameter->name) == names.end())
      return Error{"the calibration has a u of " + parameter->name +
                   ", but neither a covariance nor a sensitivity of it; refine the data again"};
  }
  return result;
}

Eigen::MatrixXd PointUncertainty::ByJoint(const turntable::System::Derivatives& of) const {
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(3, std::ssize(index_));
  for (Eigen::Index k = 0; k < std::ssize(index_); ++k)
    if (index_[k] >= 0 && index_[k] < of.by.cols()) by.col(k) = of.by.col(index_[k]);  // a form moves none
  return by;
}

PropagatedPoint PointUncertainty::At(double alpha, double y, double z) const {
  const turntable::System::Derivatives of = turntable_.system().Differentiate(alpha, y, z);
  return {{alpha, y, z}, of.point, UncertaintyOf(joint_, ByJoint(of))};
}

PropagatedDistance PointUncertainty::Between(const PropagatedPoint& a, const PropagatedPoint& b) const {
  const auto of = [&](const PropagatedPoint& p) {
    return turntable_.system().Differentiate(p.reading[0], p.reading[1], p.reading[2]);
  };
  const Eigen::MatrixXd by = ByJoint(of(b)) - ByJoint(of(a));
  Eigen::Vector3d along = b.position - a.position;
  const double value = along.norm();
  if (value > 0) {
    along /= value;
  } else {
    along = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(by * joint_.matrix * by.transpose()).eigenvectors().col(2);
  }
  return {0, 0, value, UncertaintyOf(joint_, along.transpose() * by)};
}

}  // namespace scancal
