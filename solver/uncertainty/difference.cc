#include "solver/uncertainty/difference.h"
#include <glog/logging.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include "solver/dense.h"
#include "solver/uncertainty/gum.h"

namespace scancal {
namespace {

Eigen::Matrix3d CrossOf(const Eigen::Vector3d& v) {
  return Eigen::Matrix3d{{0, -v[2], v[1]}, {v[2], 0, -v[0]}, {-v[1], v[0], 0}};
}

Eigen::Matrix3d TurnOf(const Eigen::Vector3d& v) {
  const double t = v.norm();
  return t > 0 ? Eigen::AngleAxisd(t, v / t).toRotationMatrix() : Eigen::Matrix3d::Identity();
}

Eigen::Vector3d VectorOf(const Eigen::Matrix3d& turn) {  // its length up to pi
  const Eigen::AngleAxisd angle(turn);
  return angle.angle() * angle.axis();
}

Eigen::Matrix3d JacobianOf(const Eigen::Vector3d& v) {
  constexpr double kTiny = 1e-6;
  const double t = v.norm();
  const Eigen::Matrix3d x = CrossOf(v), one = Eigen::Matrix3d::Identity();
  if (t < kTiny) return one + x / 2;
  return one + (1 - std::cos(t)) / (t * t) * x + (t - std::sin(t)) / (t * t * t) * x * x;
}

int IndexIn(const std::vector<std::string>& names, const std::string& name) {
  const auto at = std::find(names.begin(), names.end(), name);
  return at == names.end() ? -1 : static_cast<int>(at - names.begin());
}

// Old files have uncertainties, but no covariance.
Calibration WithCovariance(Calibration c) {
  if (!c.estimated.empty()) return c;
  std::vector<double> variances;
  for (const Parameter& p : c.parameters) {
    if (p.role != Role::kEstimate) continue;
    c.estimated.push_back(p.name);
    variances.push_back(p.u * p.u);
  }
  c.covariance = Eigen::VectorXd::Map(variances.data(), std::ssize(variances)).asDiagonal();
  return c;
}

// First of three names that make an orientation, by its place.
std::vector<int> TurnsIn(const std::vector<std::string>& names) {
  std::vector<int> first;
  for (int k = 0; k + 2 < std::ssize(names); ++k) {
    const std::string& name = names[k];
    if (!name.ends_with("_rx")) continue;
    const std::string what = name.substr(0, name.size() - 2);
    if (names[k + 1] == what + "ry" && names[k + 2] == what + "rz") first.push_back(k);
  }
  return first;
}

// Of all estimates, one calibration after the other, and all that was considered: name and u, "" where it is anew.
JointCovariance JointOfAll(const std::vector<JointCovariance>& each, const std::set<std::string>& anew,
                           std::vector<std::string>* shared) {
  JointCovariance all;
  Eigen::Index n = 0;
  std::vector<double> u2;
  std::vector<std::string> considered;
  std::map<std::string, std::vector<std::pair<Eigen::Index, Eigen::VectorXd>>> sensitivities;
  for (size_t i = 0; i < each.size(); ++i) {
    const JointCovariance& joint = each[i];
    const Eigen::Index own = joint.own.rows();
    all.names.insert(all.names.end(), joint.names.begin(), joint.names.begin() + own);
    for (Eigen::Index q = own; q < joint.matrix.rows(); ++q) {
      const double variance = joint.matrix(q, q);
      const std::string& plain = joint.names[q];
      const std::string name = anew.contains(plain) ? plain + " of " + std::to_string(i + 1) : plain;
      int at = IndexIn(considered, name);
      if (at < 0) {
        at = static_cast<int>(considered.size());
        considered.push_back(name);
        u2.push_back(0);
      } else if (IndexIn(*shared, name) < 0) {
        shared->push_back(name);
      }
      u2[at] = std::max(u2[at], variance);
      sensitivities[name].emplace_back(n, joint.matrix.col(q).head(own) / variance);
    }
    n += own;
  }
  const Eigen::Index size = n + std::ssize(considered);
  all.matrix = Eigen::MatrixXd::Zero(size, size);
  all.own = Eigen::MatrixXd::Zero(n, n);
  all.dof.resize(n);
  Eigen::Index at = 0;
  for (const JointCovariance& joint : each) {
    const Eigen::Index own = joint.own.rows();
    all.own.block(at, at, own, own) = joint.own;
    all.dof.segment(at, own) = joint.dof;
    at += own;
  }
  Eigen::MatrixXd s = Eigen::MatrixXd::Zero(size, std::ssize(considered));
  for (Eigen::Index q = 0; q < s.cols(); ++q) {
    for (const auto& [from, values] : sensitivities[considered[q]]) s.col(q).segment(from, values.size()) = values;
    s(n + q, q) = 1;
  }
  all.matrix.topLeftCorner(n, n) = all.own;
  all.matrix += s * Eigen::VectorXd::Map(u2.data(), std::ssize(u2)).asDiagonal() * s.transpose();
  all.names.insert(all.names.end(), considered.begin(), considered.end());
  return all;
}

Eigen::Vector3d VectorAt(const Calibration& c, const std::vector<std::string>& names, int first) {
  return {c.Find(names[first])->value, c.Find(names[first + 1])->value, c.Find(names[first + 2])->value};
}

}  // namespace

Series SeriesOf(std::span<const Calibration> given, const std::set<std::string>& anew) {
  CHECK(!given.empty());
  std::vector<Calibration> all;
  std::vector<JointCovariance> each;
  for (const Calibration& c : given) {
    all.push_back(WithCovariance(c));
    each.push_back(JointOf(all.back()));
  }
  Series series;
  for (const std::string& name : all[0].estimated)
    if (std::all_of(all.begin(), all.end(), [&](const Calibration& c) { return IndexIn(c.estimated, name) >= 0; }))
      series.names.push_back(name);
  const auto n = std::ssize(series.names);
  const std::vector<int> turns = TurnsIn(series.names);
  series.joint = JointOfAll(each, anew, &series.shared);
  series.start.resize(n);
  series.change.resize(n, std::ssize(all));
  for (Eigen::Index k = 0; k < n; ++k) {
    series.start[k] = all[0].Find(series.names[k])->value;
    series.units.push_back(all[0].Find(series.names[k])->unit);
  }
  Eigen::Index at = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    Eigen::MatrixXd by = Eigen::MatrixXd::Zero(n, series.joint.matrix.cols());
    std::vector<Eigen::Index> from(n);
    for (Eigen::Index k = 0; k < n; ++k) {
      from[k] = at + IndexIn(all[i].estimated, series.names[k]);
      by(k, from[k]) = 1;
      series.change(k, column) = all[i].Find(series.names[k])->value - series.start[k];
    }
    for (const int first : turns) {
      const Eigen::Vector3d v = VectorAt(all[i], series.names, first);
      series.change.col(column).segment<3>(first) =
          VectorOf(TurnOf(v) * TurnOf(VectorAt(all[0], series.names, first)).transpose());
      const Eigen::Matrix3d jacobian = JacobianOf(v);
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) by(first + a, from[first + b]) = jacobian(a, b);
    }
    series.by.push_back(std::move(by));
    at += std::ssize(all[i].estimated);
  }
  for (const int first : turns) series.start.segment<3>(first).setZero();
  return series;
}

double NormalizedError(double difference, double U) {
  return U > 0 && std::isfinite(U) ? difference / U : std::numeric_limits<double>::quiet_NaN();
}

bool CalibrationDifference::significant() const { return p < 1 - kCoverage; }

CalibrationDifference DifferenceOf(const Series& series) {
  CalibrationDifference result;
  result.shared = series.shared;
  if (series.names.empty()) return result;
  const Eigen::MatrixXd by = series.by.back() - series.by.front();
  const Eigen::VectorXd change = series.change.rightCols(1);
  for (Eigen::Index k = 0; k < by.rows(); ++k) {
    const MeasurandUncertainty of = UncertaintyOf(series.joint, by.row(k));
    result.changes.push_back({series.names[k], series.units[k], change[k], std::sqrt(of.covariance(0, 0)), of.U[0],
                              NormalizedError(change[k], of.U[0])});
  }
  const MeasurandUncertainty of = UncertaintyOf(series.joint, by);
  if (!of.covariance.allFinite() || !(of.covariance.diagonal().array() > 0).all()) return result;
  constexpr double kNothing = 1e-12;  // of the largest eigenvalue: a combination that no calibration told
  const Eigen::VectorXd inverse_u = of.covariance.diagonal().cwiseSqrt().cwiseInverse();
  const SymmetricEigen directions = EigenOf(Correlations(of.covariance));
  const Eigen::VectorXd along = directions.vectors.transpose() * inverse_u.cwiseProduct(change);
  for (Eigen::Index k = 0; k < along.size(); ++k) {
    if (directions.values[k] < kNothing * directions.values.maxCoeff()) continue;
    result.chi_squared += along[k] * along[k] / directions.values[k];
    ++result.n;
  }
  result.dof = of.dof;
  result.p = FUpperTail(result.chi_squared / result.n, result.n, of.dof);
  return result;
}

}  // namespace scancal
