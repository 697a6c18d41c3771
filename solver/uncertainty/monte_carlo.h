// The whole estimation repeated, and what it says of value +- U: JCGM 101, propagation of distributions.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>
#include "solver/linearize.h"
#include "solver/random.h"
#include "solver/refine.h"

namespace scancal {

// Source of a considered quantity whose u was estimated from the data -> degrees of freedom of that estimate.
using VarianceDof = std::map<std::string, double>;

// A problem whose considered quantities have drawn values: the data as the fit explains them, rows without their
// residuals, read with drawn quantities. In every view
//
//     residual(x) = weight mix (r(x, q + dq) - r(x_fit, q)),   dq ~ N(0, u^2),
//
// with one dq for the whole system, one per target, per view, per point, as the scope says; a prior becomes
// (x - x_fit) / u - N(0, 1). Weights are part of the estimator and stay what they were.
//
// JCGM 101, 5.2 and 7.4: the measurand is what the measurement function yields for a draw of its inputs, and here that
// is the estimate x(dq) from the one set of data, corrected by dq. Data made by dq and read as if it were zero would
// give x(-dq): the same to first order, but skewed to the other side. Noise is a quantity like the others.
//
// A u that was estimated from the data has a distribution too: u^2 is first drawn from the scaled inverse chi-squared,
// u^2 dof / chi2(dof), one draw for all quantities of a source (JCGM 101, 6.4.9.2). Below 8 degrees of freedom 8 are
// taken: a variance that the data hardly show has no usable chi-squared (its mean is infinite up to 2).
class DrawnProblem {
 public:
  DrawnProblem(const Problem& problem, const Estimate& fit, const VarianceDof& variance_dof);
  DrawnProblem(const DrawnProblem&) = delete;
  DrawnProblem& operator=(const DrawnProblem&) = delete;
  void Draw(Random* random);                           // a trial: everything anew
  const Problem& problem() const { return problem_; }  // views only: the nodes do not know the draws

 private:
  class DrawnRows;
  struct Influence {
    int quantity;
    Scope scope;
    double u;      // as declared or estimated
    int variance;  // which of variance_dof_; -1: known
    double drawn_u;
    double neighbour;   // correlation with the view before
    double normal = 0;  // of that view
  };
  struct Prior {
    Block* block;  // of problem_
    Eigen::VectorXd noiseless;
  };
  void RemoveResidual(const std::vector<double>& q, Block* block);

  Problem problem_;
  std::vector<Influence> influences_;
  std::vector<double> variance_dof_;
  std::vector<std::vector<std::shared_ptr<DrawnRows>>> rows_;  // per target and view that is no prior
  std::vector<Prior> priors_;
};

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

enum class Verdict { kPass, kFail, kUndecided };
const char* Name(Verdict verdict);  // "PASS", "FAIL", "UNDECIDED"

struct GumInterval {  // of one quantity: value - U to value + U
  double value = 0, u = 0, U = 0;
};

// All clauses: JCGM 101. delta = 10^l / 2, where u = c 10^l to `digits` significant digits, c whole (7.9.2): 0.5 of the
// last digit of u. 0 if u is not finite and greater than zero.
double NumericalTolerance(double u, int digits);

struct Validation {
  double mean = 0, deviation = 0;  // of the trials
  double low = 0, high = 0;        // probabilistically symmetric interval
  double d_low = 0, d_high = 0;    // how far the ends of value +- U are from it
  double tolerance = 0;            // delta
  Verdict verdict = Verdict::kUndecided;
};

// Is value +- U confirmed by the trials? The interval by order statistics (7.7) and clause 8.1: confirmed where d_low
// and d_high are at most delta. PASS and FAIL only where two standard errors of the ends, as the ranks of the sorted
// trials have them (binomial: David and Nagaraja, Order Statistics, 2003, 7.1), cannot turn the answer; else UNDECIDED,
// whose remedy is more trials. trials: at least 40.
Validation Validate(std::span<const double> trials, const GumInterval& gum, int digits);

struct AdaptiveSample {
  Eigen::MatrixXd trials;  // trials x quantities
  bool stable = false;     // else `most` was reached before
};

// The adaptive procedure of clause 7.9.4: blocks of 10^4 trials until twice the standard deviation of the averages over
// blocks of mean, deviation and both ends is below delta / 5 (8.2) for every quantity. sample(first, trials): the
// trials of these numbers; a block may be short of some. delta is that of the stated u, as in Validate: so one
// tolerance rules. At two digits this takes 3e5 (u = 1.0) to 3e7 trials (u = 9.9).
AdaptiveSample SampleUntilStable(const std::function<Eigen::MatrixXd(int64_t first, int64_t trials)>& sample,
                                 std::span<const GumInterval> gum, int digits, int64_t most);

}  // namespace scancal
