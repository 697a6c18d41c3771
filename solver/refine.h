// Joint refinement: Ceres' Levenberg-Marquardt (Marquardt 1963) to the neighbourhood, Gauss-Newton by QR to the last
// digits.
#pragma once
#include "solver/linearize.h"
#include "solver/problem.h"
#include "solver/sentence.h"

namespace scancal {

// How the step is found once the targets' own quantities are eliminated (Schur): both give the same.
enum class Elimination { kDense, kSparse, kByTargets };  // kByTargets: sparse (SuiteSparse) beyond a hundred targets

struct RefineOptions {
  int max_iterations = 100;
  Elimination elimination = Elimination::kByTargets;
};

struct Fit {
  Estimate estimate;
  double cost = 0;         // sum of squares of all weighted residuals, priors among them
  int iterations = 0;      // Ceres' and the polishing ones
  bool converged = false;  // the last step is below 1e-12 of every system quantity, below 1e-3 of its uncertainty, or
                           // rounding: below 1e-10 of every system quantity and of no use
  Sentence message;        // why not
};

// Which storey carries the fit: the nodes where they are exact, else the views.
Storey FitStorey(const Problem& problem);

// Minimises the sum of squares of all rows and priors over the estimated quantities of system and target scope. One
// residual block a target; the targets' own quantities are eliminated (Schur). Ceres' normal equations stop at about
// 1e-8 of the uncertainty, so Gauss-Newton steps by QR finish: until a step is below 1e-10 of the uncertainty, or
// rounding. One thread: the same digits everywhere.
Fit Refine(const Problem& problem, const Estimate& start, const RefineOptions& options = {});

}  // namespace scancal
