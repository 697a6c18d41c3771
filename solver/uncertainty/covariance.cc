#include "solver/uncertainty/covariance.h"
#include <algorithm>
#include "solver/dense.h"

namespace scancal {
namespace {

// (I - H)^-1/2 r of one cluster; a direction that the cluster alone determines (leverage 1) has no residual to correct.
Eigen::VectorXd Corrected(const Eigen::MatrixXd& hat, const Eigen::VectorXd& r) {
  const SymmetricEigen eigen = EigenOf(Eigen::MatrixXd::Identity(hat.rows(), hat.cols()) - hat);
  const Eigen::ArrayXd left = eigen.values.array();
  const Eigen::ArrayXd scale = (left > 1e-8).select(left.max(1e-8).rsqrt(), 0.0);
  return eigen.vectors * (scale * (eigen.vectors.transpose() * r).array()).matrix();
}

}  // namespace

double QuantityCount(const Problem& problem) {
  const auto system = problem.With({Scope::kSystem}, Role::kEstimate).size();
  const auto own = problem.With({Scope::kTarget}, Role::kEstimate).size();
  return static_cast<double>(system + own * problem.targets.size());
}

Eigen::MatrixXd InverseInformation(const Linearization& linear) {
  const auto n = linear.factor.cols();
  const Eigen::MatrixXd inverse = linear.factor.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(n, n));
  return inverse * inverse.transpose();
}

Covariance NaiveCovariance(const Problem& problem, const Linearization& linear) {
  const double dof = problem.Count() - QuantityCount(problem);
  return {InverseInformation(linear) * (dof > 0 ? linear.cost / dof : std::numeric_limits<double>::infinity()), dof};
}

std::vector<TargetScores> ScoresByTarget(const Problem& problem, const Linearization& linear) {
  const Eigen::MatrixXd inverse = InverseInformation(linear);
  std::vector<TargetScores> scores(linear.targets.size(), {0 * inverse, 0 * inverse});
  for (size_t t = 0; t < problem.targets.size(); ++t) {
    const LinearTarget& target = linear.targets[t];
    scores[t].information = target.system_left.transpose() * target.system_left;
    for (size_t v = 0; v < problem.targets[t].views.size(); ++v) {
      const Block& view = problem.targets[t].views[v];
      const auto j = target.system_left.middleRows(target.first[v], view.size());
      if (!view.prior.empty()) {
        scores[t].meat += j.transpose() * j;
        continue;
      }
      const auto q = target.q.middleRows(target.first[v], view.size());
      const Eigen::MatrixXd hat = q * q.transpose() + j * inverse * j.transpose();
      const Eigen::VectorXd score = j.transpose() * Corrected(hat, target.r.segment(target.first[v], view.size()));
      scores[t].meat += score * score.transpose();
    }
  }
  const Eigen::MatrixXd& priors = linear.targets.back().system_left;
  if (priors.size()) scores.back().information = scores.back().meat = priors.transpose() * priors;
  return scores;
}

Eigen::VectorXd DofOfClusters(const Problem& problem, const Linearization& linear) {
  const Eigen::MatrixXd inverse = InverseInformation(linear);
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(inverse.rows()), squares = sum;
  for (size_t t = 0; t < problem.targets.size(); ++t) {
    const LinearTarget& target = linear.targets[t];
    for (size_t v = 0; v < problem.targets[t].views.size(); ++v) {
      if (!problem.targets[t].views[v].prior.empty()) continue;
      const auto j = target.system_left.middleRows(target.first[v], problem.targets[t].views[v].size());
      const Eigen::ArrayXd g = (inverse * j.transpose()).rowwise().squaredNorm();
      sum += g;
      squares += g.square();
    }
  }
  return (squares > 0).select(sum.square() / squares.max(1e-300), 0.0);
}

Covariance ClusteredCovariance(const Problem& problem, const Linearization& linear) {
  const Eigen::MatrixXd inverse = InverseInformation(linear);
  Eigen::MatrixXd meat = 0 * inverse;
  for (const TargetScores& target : ScoresByTarget(problem, linear)) meat += target.meat;
  double clusters = 0;
  for (const Target& target : problem.targets)
    for (const Block& view : target.views) clusters += view.prior.empty();
  return {inverse * meat * inverse, std::max(0.0, clusters - QuantityCount(problem))};
}

}  // namespace scancal
