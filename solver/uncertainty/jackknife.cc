#include "solver/uncertainty/jackknife.h"

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

}  // namespace scancal
