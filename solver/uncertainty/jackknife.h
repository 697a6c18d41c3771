// Leave one target out: which placement moves which parameter, and whether one contradicts the others.
#pragma once
#include <Eigen/Core>
#include <vector>
#include "solver/refine.h"

namespace scancal {

struct Jackknife {
  // targets x system: the fit without that target; empty with fewer than two targets, and with more than 40: none of
  // them moves anything, and time goes with their square.
  Eigen::MatrixXd estimates;
  Eigen::MatrixXd covariance;  // m - 1 degrees of freedom: a diagnostic, no headline
  bool converged = true;
};

// Each target left out in turn, the rest fitted anew: (m - 1)/m sum (x_i - mean)(x_i - mean)' (Tukey 1958; Efron and
// Tibshirani, An Introduction to the Bootstrap, 1993, eq. (11.5)). Where the residuals are linear enough over the move,
// so that it is right to a hundredth of u, one Gauss-Newton step on the merged triangles of the others is the fit.
// linear: of the views, at the fit.
Jackknife LeaveOneTargetOut(const Problem& problem, const Fit& fit, const Linearization& linear);

// What the variances of the jackknife would be on average if views were independent, as the clustered covariance
// supposes, but for neighbours whose correlation was estimated. Not that covariance itself: few targets, each needed by
// the others, scatter more. To first order, leaving target i out moves the fit by (H - H_i)^-1 s_i (one Newton step
// from the fit; Miller 1974), where s_i = s_i0 - H_i H^-1 sum_j s_j0 is its score at the fit and s_j0 has the
// covariance of its clusters and of what was considered: of target scope its own, of system scope common.
struct ExpectedJackknife {
  Eigen::VectorXd variance;  // per system quantity
  Eigen::VectorXd dof;       // of a chi-squared with the same mean and spread (Satterthwaite 1946); at most targets - 1
};
ExpectedJackknife ExpectLeaveOneTargetOut(const Problem& problem, const Estimate& fit, const Linearization& linear);

// Does a target contradict the others? Its score at the joint fit, b = L'r with L its rows of the system, against what
// noise and everything considered make of it (Chow 1960, Econometrica 28, 591, as the score test of Rao 1948): without
// influences the covariance of b is A_t - A_t A^-1 A_t, and F is the drop of the sum of squares when the target is
// given system quantities of its own, over its degrees of freedom. Only directions count that both the target and the
// others determine. The problem is weighed with its noise, of noise_dof degrees of freedom.
struct TargetTest {
  double F = 0, dof1 = 0;  // dof1 = 0: it shares nothing with the others
  double p = 1;            // for this target, among all (Bonferroni)
  // Of the system's estimates without it, as far as nothing that was considered explains them (what of the score is
  // left after its best prediction from what was considered).
  Eigen::VectorXd moves;
};
std::vector<TargetTest> TestTargets(const Problem& problem, const Estimate& fit, const Linearization& linear,
                                    double noise_dof);

// Targets that took no part, against the fit: with their own quantities fitted, their residuals d have the covariance
// I + L S L' (L their rows of the system, S = covariance the fit's), so that
//
//     F = d' (I + L S L')^-1 d / dof1
//
// (out-of-sample Chow test; Hamilton, Time Series Analysis, 1994, 8.1). at: the fit of the system, and of the targets'
// own quantities where they start. The problem is weighed with the noise of the calibration, of noise_dof.
struct HeldOutTest {
  static constexpr double kMore = 1.2;  // times what is explained: less is of no consequence
  double F = 0, dof1 = 0, p = 1;
  bool Contradicts() const;  // significant, and more than that
};
HeldOutTest TestHeldOut(const Problem& held_out, const Estimate& at, const Eigen::MatrixXd& covariance,
                        double noise_dof);

}  // namespace scancal
