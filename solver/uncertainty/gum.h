// The formulas of the GUM (JCGM 100) for an uncertainty statement: law of propagation, degrees of freedom, k.
#pragma once
#include <Eigen/Core>
#include <limits>
#include <span>

namespace scancal {

// Covariance of y = f(x) to first order: S V S', with S = df/dx (outputs x inputs) and V the covariance of x with what
// stands off its diagonal (JCGM 100 eq. 13, JCGM 102 6.2.1.3). Blind where S is zero at the estimate (GUM H.1.7).
Eigen::MatrixXd PropagateCovariance(const Eigen::MatrixXd& sensitivity, const Eigen::MatrixXd& covariance);

Eigen::MatrixXd Correlations(const Eigen::MatrixXd& covariance);  // r_ij = v_ij / (u_i u_j)

// Effective degrees of freedom of a sum of contributions u_i with dof_i each, infinite where u_i is exactly known:
// (sum u_i^2)^2 / sum (u_i^4 / dof_i) (Welch-Satterthwaite, JCGM 100 eq. G.2b). For independent contributions only.
double EffectiveDof(std::span<const double> contributions, std::span<const double> dofs);

inline constexpr double kCoverage = 0.95;  // probability that a stated interval or region holds the true value

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();  // dof of what is known exactly

// k with P(|t| <= k) = coverage for Student's t (GUM G.3); dof may be fractional; infinite below 1.
double CoverageFactor(double coverage, double dof);
// k of the joint region of n quantities: x with (x - x0)' C^-1 (x - x0) <= k^2 holds all of them with this coverage,
// k^2 = n F(coverage; n, dof), or chi^2(coverage; n) of a known variance (Scheffe, The Analysis of Variance, 1959,
// ch. 2; JCGM 102, 6.5.2). Larger than the k of one.
double JointCoverageFactor(double coverage, double n, double dof);
// P(F >= f) with dof1, dof2 degrees of freedom: the p of an F test; dof2 may be infinite, dof1 F is then chi^2.
double FUpperTail(double f, double dof1, double dof2);

}  // namespace scancal
