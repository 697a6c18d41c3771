// From a problem and a start to a Calibration: refinement, covariances side by side, what is determined.
#pragma once
#include "solver/calibration.h"
#include "solver/observability.h"
#include "solver/refine.h"

namespace scancal {

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
};

// Refines and looks at what the data determine. Does not judge.
Solution Solve(Problem problem, const Estimate& start, const RefineOptions& options = {});

// Numbers of a solution: parameters with all their uncertainties, covariance, budget of what was considered, lack of
// fit, jackknife. sigma: the standard deviation by which the rows were divided, mm. The model adds what only it can
// say.
Calibration Summarize(const Solution& solution, double sigma, const PureError& pure_error);

}  // namespace scancal
