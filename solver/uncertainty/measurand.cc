#include "solver/uncertainty/measurand.h"
#include <glog/logging.h>
#include <algorithm>
#include <cmath>
#include "solver/dense.h"
#include "solver/uncertainty/gum.h"

namespace scancal {
namespace {

// Of the variance that the gradient makes of the joint covariance.
double EffectiveDof(const JointCovariance& joint, const Eigen::RowVectorXd& gradient) {
  const Eigen::RowVectorXd by_own = gradient.head(joint.own.rows());
  const double own = by_own * joint.own * by_own.transpose();
  if (!(own > 0)) return kInfinity;
  double dof = kInfinity;
  for (Eigen::Index k = 0; k < by_own.size(); ++k)
    if (by_own[k] != 0) dof = std::min(dof, joint.dof[k]);
  const double total = gradient * joint.matrix * gradient.transpose();
  return dof * std::pow(total / own, 2);
}

}  // namespace

JointCovariance JointOf(const Calibration& calibration) {
  const auto n = std::ssize(calibration.estimated);
  CHECK_EQ(calibration.covariance.rows(), n);
  std::vector<const BudgetLine*> considered;
  for (const BudgetLine& line : calibration.budget) {
    const Parameter* quantity = calibration.Find(line.source);
    if (quantity && quantity->role == Role::kConsider && std::ssize(line.sensitivity) == n && line.u > 0)
      considered.push_back(&line);
  }
  JointCovariance joint;
  joint.names = calibration.estimated;
  joint.matrix = Eigen::MatrixXd::Zero(n + std::ssize(considered), n + std::ssize(considered));
  joint.matrix.topLeftCorner(n, n) = joint.own = calibration.covariance;
  for (const BudgetLine* line : considered) {
    const auto q = std::ssize(joint.names);
    const Eigen::Map<const Eigen::VectorXd> s(line->sensitivity.data(), n);
    joint.matrix.col(q).head(n) = joint.matrix.row(q).head(n) = s * line->u * line->u;
    joint.matrix(q, q) = line->u * line->u;
    joint.own -= s * s.transpose() * line->u * line->u;
    joint.names.push_back(line->source);
  }
  joint.dof.resize(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double of_own = std::max(0.0, joint.own(k, k)) / calibration.covariance(k, k);
    joint.dof[k] = of_own > 0 ? calibration.Find(joint.names[k])->dof * of_own * of_own : kInfinity;
  }
  return joint;
}

void JointCovariance::Renew(const std::string& name) {
  const auto k = std::find(names.begin(), names.end(), name) - names.begin();
  if (k == std::ssize(names)) return;
  for (Eigen::MatrixXd* covariance : {&matrix, &own}) {
    if (k >= covariance->rows()) continue;
    const double variance = (*covariance)(k, k);
    covariance->row(k).setZero();
    covariance->col(k).setZero();
    (*covariance)(k, k) = variance;
  }
}

MeasurandUncertainty UncertaintyOf(const JointCovariance& joint, const Eigen::MatrixXd& by) {
  CHECK_EQ(by.cols(), joint.matrix.cols());
  MeasurandUncertainty result;
  result.covariance = by * joint.matrix * by.transpose();
  result.U = Eigen::VectorXd::Constant(by.rows(), kInfinity);
  result.k = result.U_max = kInfinity;
  if (!result.covariance.allFinite()) return result;
  const SymmetricEigen directions = EigenOf(result.covariance);  // ascending
  result.dof = EffectiveDof(joint, directions.vectors.rightCols(1).transpose() * by);
  for (const auto& component : by.rowwise()) result.dof = std::min(result.dof, EffectiveDof(joint, component));
  result.k = CoverageFactor(kCoverage, result.dof);
  result.U = result.k * result.covariance.diagonal().cwiseMax(0).cwiseSqrt();
  result.U_max = result.k * std::sqrt(std::max(0.0, directions.values.tail(1)[0]));
  return result;
}

}  // namespace scancal
