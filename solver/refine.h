// Joint refinement: Gauss-Newton to the last digits; where that does not settle, Ceres' Levenberg-Marquardt (Marquardt
// 1963) to the neighbourhood first.
#pragma once
#include "solver/linearize.h"
#include "solver/problem.h"
#include "solver/sentence.h"

namespace scancal {

// How Ceres finds the step once the targets' own quantities are eliminated (Schur): both give the same.
enum class Elimination {
  kDense,  // Ceres from the start
  kSparse,
  kByTargets  // where Ceres is needed, sparse (SuiteSparse) beyond a hundred targets
};

struct RefineOptions {
  int max_iterations = 100;
  Elimination elimination = Elimination::kByTargets;
};

struct Fit {
  Estimate estimate;
  double cost = 0;         // sum of squares of all weighted residuals, priors among them
  int iterations = 0;      // Gauss-Newton's, and Ceres' where it was needed
  bool converged = false;  // the last step is below 1e-12 of every system quantity, below 1e-3 of its uncertainty, or
                           // rounding: below 1e-10 of every system quantity and of no use
  Sentence message;        // why not
};

// Which storey carries the fit: the nodes where they are exact, else the views.
Storey FitStorey(const Problem& problem);

// Minimises the sum of squares of all rows and priors over the estimated quantities of system and target scope; the
// targets' own quantities are eliminated (Schur). From a good start a few Gauss-Newton steps suffice: until a step is
// below 1e-10 of the uncertainty, or rounding. Where one of them makes the residuals larger, Ceres begins again, with a
// residual block a target; it stops at about 1e-8 of the uncertainty, and Gauss-Newton finishes. One thread: the same
// digits everywhere.
Fit Refine(const Problem& problem, const Estimate& start, const RefineOptions& options = {});

}  // namespace scancal
