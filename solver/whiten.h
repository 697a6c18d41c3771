// The one place where a covariance becomes a weight.
#pragma once
#include <Eigen/Core>

namespace scancal {

// W with W V W' = I, for residuals of covariance V (n x n, symmetric, positive definite): W = L^-1 where V = L L'.
// Written once because W is easily applied untransposed: the factor of V^-1 = W' W multiplies residuals as W, never as
// W'. CHECKs that V is positive definite: every row needs noise of its own.
Eigen::MatrixXd Whitening(const Eigen::MatrixXd& covariance);

}  // namespace scancal
