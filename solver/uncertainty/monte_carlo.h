// The whole estimation repeated: JCGM 101, propagation of distributions.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include "solver/linearize.h"
#include "solver/refine.h"
#include "solver/uncertainty/drawn_problem.h"

namespace scancal {

struct MonteCarloOptions {
  int64_t trials = 10'000;
  int64_t first = 0;  // number of the first trial: blocks of one long sample
  uint64_t seed = 1;
  int threads = 0;                                       // 0: one a core
  std::function<void(double fraction_done)> progress{};  // called from the calling thread
};

struct MonteCarloSample {
  Eigen::MatrixXd estimates;  // settled trials x system, in the order of their numbers
  int64_t failed = 0;         // trials whose estimation did not settle; they are left out
};

// One estimate of the system's quantities per trial: the joint fit of a DrawnProblem of its own, to a millionth of the
// standard uncertainty where Refine would end. Trial k draws from stream k of the seed, so the digits do not depend on
// threads or blocks. linear: of the views, at the fit. Memory: the estimates, and one copy of the problem a thread.
// Weights are those of the problem: what a user gets who estimates variances once and keeps them.
MonteCarloSample MonteCarlo(const Problem& problem, const Fit& fit, const Linearization& linear,
                            const VarianceDof& variance_dof, const MonteCarloOptions& options);

}  // namespace scancal
