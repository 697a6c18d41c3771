#include "solver/uncertainty/jackknife.h"
#include <Eigen/LU>
#include <cmath>
#include "solver/uncertainty/covariance.h"

namespace scancal {

Jackknife LeaveOneTargetOut(const Problem& problem, const Fit& fit) {
  Jackknife result;
  const auto m = std::ssize(problem.targets);
  if (m < 2) return result;
  result.estimates.resize(m, fit.estimate.system.size());
  for (std::ptrdiff_t t = 0; t < m; ++t) {
    Problem rest = problem;
    Estimate start = fit.estimate;
    rest.targets.erase(rest.targets.begin() + t);
    start.targets.erase(start.targets.begin() + t);
    const Fit without = Refine(rest, start);
    result.estimates.row(t) = without.estimate.system.transpose();
    result.converged &= without.converged;
  }
  const Eigen::MatrixXd centred = result.estimates.rowwise() - result.estimates.colwise().mean();
  result.covariance = centred.transpose() * centred * static_cast<double>(m - 1) / static_cast<double>(m);
  return result;
}

ExpectedJackknife ExpectLeaveOneTargetOut(const Problem& problem, const Linearization& linear) {
  const std::vector<TargetScores> scores = ScoresByTarget(problem, linear);
  const Eigen::MatrixXd inverse = InverseInformation(linear);
  const auto n = inverse.rows();
  const size_t m = problem.targets.size();
  Eigen::MatrixXd information = 0 * inverse;
  for (const TargetScores& target : scores) information += target.information;
  // moves[i]: n x (n m), how the scores of all targets move the fit without target i.
  std::vector<Eigen::MatrixXd> moves(m);
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(n, n * static_cast<Eigen::Index>(m));
  for (size_t i = 0; i < m; ++i) {
    const Eigen::MatrixXd without = (information - scores[i].information).inverse();
    moves[i].resize(n, mean.cols());
    for (size_t j = 0; j < m; ++j)
      moves[i].middleCols(static_cast<Eigen::Index>(j) * n, n) =
          without * ((i == j ? 1 : 0) * Eigen::MatrixXd::Identity(n, n) - scores[i].information * inverse);
    mean += moves[i] / static_cast<double>(m);
  }
  ExpectedJackknife expected{Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (Eigen::Index k = 0; k < n; ++k) {
    // Covariance of the m centred moves of this quantity; the sum of their squares is what the jackknife sees.
    Eigen::MatrixXd rows(static_cast<Eigen::Index>(m), mean.cols());
    for (size_t i = 0; i < m; ++i) rows.row(static_cast<Eigen::Index>(i)) = moves[i].row(k) - mean.row(k);
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(rows.rows(), rows.rows());
    for (size_t j = 0; j < m; ++j) {
      const auto block = rows.middleCols(static_cast<Eigen::Index>(j) * n, n);
      covariance += block * scores[j].meat * block.transpose();
    }
    expected.variance[k] = covariance.trace() * static_cast<double>(m - 1) / static_cast<double>(m);
    expected.dof[k] = std::pow(covariance.trace(), 2) / covariance.squaredNorm();
  }
  return expected;
}

}  // namespace scancal
