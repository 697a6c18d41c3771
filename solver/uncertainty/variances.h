// How large the random influences are, told by the residuals.
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>
#include "solver/problem.h"

namespace scancal {

// A declared u of view or point scope that the residuals exceed by more than their own uncertainty explains.
struct Exceeded {
  std::string source;
  double declared = 0, estimated = 0;
  double p = 1;  // of an estimate as large, if the declared one were right (chi-squared, with the estimate's dof)
};

struct Variances {
  std::vector<std::string> sources;  // estimated; their quantities share one u
  Eigen::VectorXd variance;          // u^2 of each
  Eigen::MatrixXd covariance;        // of the variances: inverse of their expected information
  std::vector<Exceeded> exceeded;    // estimated in place of what was declared
  bool converged = true;
  // 2 v^2 / var(v): those of a chi-squared with the same mean and spread (Satterthwaite 1946). Infinite for a source
  // that was not estimated.
  double Dof(const std::string& source) const;
  // Of the variance sum_k share[k], share[k] that of source k: 2 (sum)^2 / var(sum) if `total` is the whole (GUM G.4
  // with all that was estimated as one block).
  double Dof(const Eigen::VectorXd& share, double total) const;
};

// Restricted maximum likelihood (Patterson and Thompson 1971) of the variances of all quantities of view and point
// scope whose role is estimate, by Fisher scoring on the rows: with P = V^-1 - V^-1 J (J'V^-1 J)^-1 J'V^-1,
//
//     score_k = (r'P V_k P r - tr P V_k) / 2,   information_kl = tr(P V_k P V_l) / 2,
//
// and the count - size observations that a view has beyond its rows independent of everything but the point noise.
// Those that are declared (role consider) are kept, unless the residuals show more: then the larger one is used.
//
// Afterwards every such quantity is considered with its u, the problem is weighed, and `at` is its minimum to first
// order. least: the smallest standard deviation of a row, for data without noise.
Variances EstimateVariances(Problem* problem, Estimate* at, double least);

}  // namespace scancal
