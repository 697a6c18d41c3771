// Generalised least squares: every view weighted with its own covariance.
#pragma once
#include "solver/problem.h"

namespace scancal {

// What the instances of one quantity do to the rows of a view: rows x 1, or for point scope rows x points, of which
// column i acts on the rows of point i only. derivative: dr/dq, rows.
Eigen::MatrixXd Instances(const Eigen::VectorXd& derivative, int points, Scope scope);

// dr/dq of the seeds as the model says, without weight, mix or offset: rows x seeds.
Eigen::MatrixXd RawDerivatives(const Block& view, const std::vector<double>& values, std::span<const int> seeds);

// Divides the rows of each view by their noise: W with W V W' = I for V = sum of (dr/dq) u^2 (dr/dq)' over the
// considered quantities of view and point scope. CHECKs that every row has noise of its own. Priors keep theirs.
void Weigh(Problem* problem, const Estimate& at);

}  // namespace scancal
