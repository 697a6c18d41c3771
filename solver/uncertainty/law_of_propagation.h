// The law of propagation of uncertainty, for a function of a few quantities.
#pragma once
#include <Eigen/Core>
#include <span>

namespace scancal {

// Covariance of y = f(x) to first order: S V S', with S = df/dx (outputs x inputs) and V the covariance of x with what
// stands off its diagonal (JCGM 100 eq. 13, JCGM 102 6.2.1.3). Blind where S is zero at the estimate (GUM H.1.7).
Eigen::MatrixXd PropagateCovariance(const Eigen::MatrixXd& sensitivity, const Eigen::MatrixXd& covariance);

Eigen::MatrixXd Correlations(const Eigen::MatrixXd& covariance);  // r_ij = v_ij / (u_i u_j)

// Effective degrees of freedom of a sum of contributions u_i with dof_i each, infinite where u_i is exactly known:
// (sum u_i^2)^2 / sum (u_i^4 / dof_i) (Welch-Satterthwaite, JCGM 100 eq. G.2b). For independent contributions only.
double EffectiveDof(std::span<const double> contributions, std::span<const double> dofs);

}  // namespace scancal
