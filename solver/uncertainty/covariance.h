// Covariances of the system's estimated quantities that need nothing but the residuals.
#pragma once
#include <Eigen/Core>
#include <vector>
#include "solver/linearize.h"

namespace scancal {

double QuantityCount(const Problem& problem);  // estimated ones, of the system and of every target

// (J'J)^-1 of the system after elimination of the targets' own quantities; from the triangle, J'J is never formed.
Eigen::MatrixXd InverseInformation(const Linearization& linear);

struct Covariance {
  Eigen::MatrixXd matrix;  // system x system, in the units of the quantities
  double dof = 0;
};

// s^2 (J'J)^-1, s^2 = cost / (observations - quantities) (GUM H.3.2 for a line; Seber and Wild, Nonlinear Regression,
// 1989, 2.1): right only for white, independent points. Shown for
// comparison.
Covariance NaiveCovariance(const Problem& problem, const Linearization& linear);

// Sandwich (J'J)^-1 (sum_c g_c g_c') (J'J)^-1 with one cluster per view, g_c = J_c' (I - H_cc)^-1/2 r_c: (White 1980;
// Liang and Zeger 1986): right whenever views are independent of each other, whatever happens inside one (jitter, line
// correlation). The leverage correction H_cc makes it unbiased for white noise (Bell and McCaffrey 2002, "CR2"). Priors
// enter with their own unit noise, not their residual. dof: clusters minus quantities. linear: of the views.
Covariance ClusteredCovariance(const Problem& problem, const Linearization& linear);

// Degrees of freedom of each variance of the clustered covariance, as it would be of the noise that the problem is
// weighed with: (sum g)^2 / sum g^2 over the clusters, g what each contributes (Satterthwaite 1946).
Eigen::VectorXd DofOfClusters(const Problem& problem, const Linearization& linear);

// Per target, last the priors: J'J of the system, and the sum over its clusters of g_c g_c'.
struct TargetScores {
  Eigen::MatrixXd information, meat;
};
std::vector<TargetScores> ScoresByTarget(const Problem& problem, const Linearization& linear);

}  // namespace scancal
