#include "models/turntable/calibrated_turntable.h"
#include <Eigen/Eigenvalues>
#include <algorithm>
#include "models/turntable/measured_point.h"

namespace scancal {
namespace {

constexpr int kSystemQuantities = Turntable::kNormal1;

const Quantities& AllQuantities() {
  static const Turntable turntable(Turntable::Residuals::kDepth);
  return turntable.quantities();
}

}  // namespace

Result<CalibratedTurntable> CalibratedTurntable::From(const Calibration& calibration) {
  std::vector<double> q(AllQuantities().size(), 0.0);
  for (int k = 0; k < kSystemQuantities; ++k) {
    const std::string& name = AllQuantities()[k].name;
    if (const Parameter* parameter = calibration.Find(name)) {
      q[k] = parameter->value;
    } else if (k == Turntable::kM || k == Turntable::kN) {
      return Error{"the calibration has no parameter " + name + ", expected the result of a turntable"};
    }
  }
  const std::optional<ScannedVolume> volume = VolumeOf(calibration);
  if (q[Turntable::kLinearity] != 0 && !volume)
    return Error{"the calibration has a linearity, but no volume to tell the range of depths; refine the data again"};
  return CalibratedTurntable(std::move(q), volume.value_or(ScannedVolume()));
}

Eigen::Vector3d CalibratedTurntable::Point(double alpha, double y, double z) const {
  return MeasuredPoint(alpha, y, z, volume_.Eta(y), Seen<double>{q_.data(), nullptr, static_cast<int>(q_.size())});
}

CalibratedTurntable::Derivatives CalibratedTurntable::Differentiate(double alpha, double y, double z) const {
  using Jet = ceres::Jet<double, kSystemQuantities>;
  std::vector<Jet> q(q_.begin(), q_.end());
  for (int k = 0; k < kSystemQuantities; ++k) q[k].v[k] = 1;
  const Eigen::Matrix<Jet, 3, 1> p =
      MeasuredPoint(alpha, y, z, volume_.Eta(y), Seen<Jet>{q.data(), nullptr, static_cast<int>(q.size())});
  Derivatives result{{p[0].a, p[1].a, p[2].a}, Eigen::MatrixXd(3, kSystemQuantities)};
  for (int i = 0; i < 3; ++i) result.by.row(i) = p[i].v.transpose();
  return result;
}

Result<PointUncertainty> PointUncertainty::From(const Calibration& calibration) {
  SCANCAL_ASSIGN_OR_RETURN(CalibratedTurntable turntable, CalibratedTurntable::From(calibration));
  if (!VolumeOf(calibration))
    return Error{"the calibration has no volume, so an older version wrote it; refine the data again"};
  PointUncertainty result(std::move(turntable), JointOf(calibration));
  result.joint_.Renew(AllQuantities()[Turntable::kExpansion].name);
  const std::vector<std::string>& names = result.joint_.names;
  for (const std::string& name : names) result.index_.push_back(Find(AllQuantities(), name));
  for (int k = 0; k < kSystemQuantities; ++k) {
    const Parameter* parameter = calibration.Find(AllQuantities()[k].name);
    if (parameter && parameter->u > 0 && std::find(names.begin(), names.end(), parameter->name) == names.end())
      return Error{"the calibration has a u of " + parameter->name +
                   ", but neither a covariance nor a sensitivity of it; refine the data again"};
  }
  return result;
}

CalibratedTurntable::Derivatives PointUncertainty::ByJoint(const std::vector<double>& reading) const {
  const CalibratedTurntable::Derivatives all = turntable_.Differentiate(reading[0], reading[1], reading[2]);
  CalibratedTurntable::Derivatives result{all.point, Eigen::MatrixXd::Zero(3, std::ssize(index_))};
  for (Eigen::Index k = 0; k < std::ssize(index_); ++k)
    if (index_[k] >= 0 && index_[k] < kSystemQuantities) result.by.col(k) = all.by.col(index_[k]);  // a form moves none
  return result;
}

PropagatedPoint PointUncertainty::At(double alpha, double y, double z) const {
  const auto [point, by] = ByJoint({alpha, y, z});
  return {{alpha, y, z}, point, UncertaintyOf(joint_, by)};
}

PropagatedDistance PointUncertainty::Between(const PropagatedPoint& a, const PropagatedPoint& b) const {
  const Eigen::MatrixXd by = ByJoint(b.reading).by - ByJoint(a.reading).by;
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
