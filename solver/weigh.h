// Generalised least squares (Aitken 1935): every view weighted with its own covariance.
#pragma once
#include "solver/problem.h"

namespace scancal {

// The one place where a covariance becomes a weight: W with W V W' = I, for residuals of covariance V (n x n,
// symmetric, positive definite): W = L^-1 where V = L L'. Written once because W is easily applied untransposed: the
// factor of V^-1 = W' W multiplies residuals as W, never as W'. CHECKs that V is positive definite: every row needs
// noise of its own.
Eigen::MatrixXd Whitening(const Eigen::MatrixXd& covariance);

// What the instances of one quantity do to the rows of a view: rows x 1, or for point scope rows x points, of which
// column i acts on the rows of point i only. derivative: dr/dq, rows.
Eigen::MatrixXd Instances(const Eigen::VectorXd& derivative, int points, Scope scope);

// dr/dq of the seeds as the model says, without weight, mix or offset: rows x seeds.
Eigen::MatrixXd RawDerivatives(const Block& view, const std::vector<double>& values, std::span<const int> seeds);

// Divides the rows of each view by their noise: W with W V W' = I for V = sum of (dr/dq) u^2 (dr/dq)' over the
// considered quantities of view and point scope (GUM 5.1.2 for several outputs: JCGM 102, 6.2). CHECKs that every row
// has noise of its own. Priors keep theirs.
void Weigh(Problem* problem, const Estimate& at);

}  // namespace scancal
