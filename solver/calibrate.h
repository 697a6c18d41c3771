// From a problem and a start to a Calibration: refinement, weights, covariances side by side, what is determined.
#pragma once
#include <optional>
#include <utility>
#include "solver/calibration.h"
#include "solver/linearize.h"
#include "solver/refine.h"
#include "solver/uncertainty/covariance.h"
#include "solver/uncertainty/jackknife.h"
#include "solver/uncertainty/neighbours.h"
#include "solver/uncertainty/variances.h"

namespace scancal {

inline constexpr double kLeastSigma_mm = 1e-9;  // noiseless data need a scale too

struct PureError {  // what repeats within a view, from the data alone
  double sum_of_squares = 0;
  double dof = 0;
  double sigma() const;  // 0 if there are no degrees of freedom
};

struct Solution {
  Problem problem;
  Fit fit;
  Linearization linear;  // of the views, at the fit
  Observability observability;
  Covariance naive;                    // of the fit with equal weights
  std::optional<Variances> variances;  // those that weigh the problem; none: equal weights
  NeighboursFound neighbours = {};
};

// Refines and looks at what the data determine. Does not judge.
Solution Solve(Problem problem, const Estimate& start, const RefineOptions& options = {});

// The same by generalised least squares: the variances of all random influences from the residuals, or as declared, and
// every view weighted with its own covariance. least: see EstimateVariances.
Solution SolveWeighted(const Solution& plain, double least, const RefineOptions& options = {});

// Of each view of a target, without weights and priors: in the units and the frame of the model.
std::vector<Eigen::VectorXd> ResidualsOf(const Solution& solution, size_t target);

// The uncertainty that is stated, and its budget.
struct Headline {
  Eigen::MatrixXd covariance;  // of the system's estimated quantities
  Eigen::VectorXd dof;         // effective degrees of freedom of each variance (Welch-Satterthwaite, GUM G.4)
  std::vector<BudgetLine> budget;
  std::vector<Sentence> warnings;
};

// Weighted fits: K V K' with everything random, declared or estimated, and everything that was considered; the
// estimated variances are one block in the degrees of freedom. Where the residuals show more between views than all of
// that explains (clustered, by its F test, p < 0.001 after Bonferroni), what is lacking is a line of its own. Equal
// weights: what the residuals show between views (clustered), and what cannot show there because views share it.
Headline HeadlineOf(const Solution& solution, const Covariance& clustered);

// Numbers of a solution: parameters with all their uncertainties, covariance, budget, lack of fit, jackknife. u is
// K V K' of everything that was estimated or declared where the fit is weighted; else clustered by view, and what all
// views share. The model adds what only it can say.
Calibration Summarize(const Solution& solution, const PureError& pure_error);

inline constexpr double kSuspicious = 1e-3;  // p: a warning that a right data set raises once in a thousand

// The estimated parameter that moves furthest in units of its u, and by how many; moves: one per estimated parameter.
std::pair<std::string, double> Furthest(const std::vector<double>& moves, const Calibration& result);

// Adds to warnings what is worth knowing, to unreliable what forbids relying on the result: no convergence, too few
// views, targets that contradict each other, data that contradict a prior, and what the model leaves out if it is
// significant and moves a quantity by more than its u. With equal weights lack of fit is a warning only. noise_dof:
// degrees of freedom of what is known of the noise.
void AddDoubts(const Solution& solution, const Jackknife& jackknife, double noise_dof, Calibration* calibration);

}  // namespace scancal
