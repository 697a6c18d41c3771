#include "solver/uncertainty/monte_carlo.h"
#include <glog/logging.h>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>
#include "solver/uncertainty/propagate.h"

namespace scancal {
namespace {

constexpr int64_t kChunk = 16;        // trials that a thread takes at a time
constexpr int kMostSteps = 10;        // of Gauss-Newton, before Refine is asked
constexpr double kTolerance = 1e-6;   // of a standard uncertainty
constexpr double kLeastRatio = 1e-2;  // of two steps: two may by chance differ more than the next two

// Of the estimates. Not below the rounding of a quantity's own size (of one unit, where it is smaller), as in Refine.
Eigen::ArrayXd StandardUncertainties(const Problem& problem, const Fit& fit, const Linearization& linear) {
  const Eigen::ArrayXd least = 1e-12 / kTolerance * fit.estimate.system.array().abs().max(1.0);
  const Eigen::MatrixXd covariance = Propagate(problem, fit.estimate, linear).Total();
  return covariance.size() ? covariance.diagonal().array().sqrt().max(least) : least;
}

// Gauss-Newton by QR from near the minimum to where Refine would end. Each step shortens the error by about the same
// factor: done when the last step, times its ratio to the one before, is negligible.
Fit Settle(const Problem& problem, const Estimate& from, const Eigen::ArrayXd& u) {
  Fit fit;
  fit.estimate = from;
  double before = 0;
  for (; fit.iterations < kMostSteps; ++fit.iterations) {
    const Linearization linear = Linearize(problem, fit.estimate, Storey::kViews);
    if (!std::isfinite(linear.cost)) break;
    const Estimate step = GaussNewtonStep(linear);
    Add(step, &fit.estimate);
    const double length = (step.system.array().abs() / u).maxCoeff();
    const double ratio = before > 0 ? std::clamp(length / before, kLeastRatio, 1.0) : 1;
    fit.converged = length * ratio <= kTolerance;
    if (fit.converged) return fit;
    before = length;
  }
  // From a start without residuals Refine could only complain.
  return fit.iterations > 0 ? Refine(problem, from) : fit;
}

}  // namespace

MonteCarloSample MonteCarlo(const Problem& problem, const Fit& fit, const Linearization& linear,
                            const VarianceDof& variance_dof, const MonteCarloOptions& options) {
  constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
  CHECK_GT(fit.estimate.system.size(), 0) << "there is nothing to estimate";
  const Eigen::ArrayXd u = StandardUncertainties(problem, fit, linear);
  Eigen::MatrixXd estimates = Eigen::MatrixXd::Constant(options.trials, fit.estimate.system.size(), kMissing);
  std::atomic<int64_t> next = 0, failed = 0;
  const auto work = [&](bool shows_progress) {
    DrawnProblem drawn(problem, fit.estimate, variance_dof);
    for (int64_t begin; (begin = next.fetch_add(kChunk)) < options.trials;) {
      if (shows_progress && options.progress)
        options.progress(static_cast<double>(begin) / static_cast<double>(options.trials));
      for (int64_t trial = begin; trial < std::min(begin + kChunk, options.trials); ++trial) {
        Random random(options.seed, static_cast<uint64_t>(options.first + trial));
        drawn.Draw(&random);
        const Fit again = Settle(drawn.problem(), fit.estimate, u);
        if (again.converged) {
          estimates.row(trial) = again.estimate.system.transpose();
        } else {
          ++failed;
        }
      }
    }
  };
  const int threads = options.threads > 0 ? options.threads : static_cast<int>(std::thread::hardware_concurrency());
  std::vector<std::jthread> others;
  for (int k = 1; k < threads; ++k) others.emplace_back(work, false);
  work(true);
  others.clear();  // joins
  Eigen::Index settled = 0;
  for (Eigen::Index trial = 0; trial < estimates.rows(); ++trial)
    if (estimates.row(trial).allFinite()) estimates.row(settled++) = estimates.row(trial);
  estimates.conservativeResize(settled, Eigen::NoChange);
  return {std::move(estimates), failed};
}

}  // namespace scancal
