// Views in an order, of which neighbours err alike.
#pragma once
#include <string>
#include "solver/linearize.h"
#include "solver/uncertainty/variances.h"

namespace scancal {

struct NeighboursFound {
  enum { kNone, kNoise, kTooSlow, kSmooth } what = kNone;
  double correlation = 0;  // kTooSlow: of neighbours
  std::string source;      // kSmooth: what is held of a target, and the u that explains the residuals
  double u = 0;
};

// The quantities of view scope that are in_order as first-order autoregressive processes along the views of a target:
// x_v = rho x_v-1 + w_v, of standard deviation u each, and one rho for all. rho and the u that were estimated come from
// the restricted likelihood
//
//     -2 l = sum log|S_v| + log|J'V^-1 J| + r'P r,
//
// whose V is whitened view by view by a Kalman filter (Harvey, Forecasting, Structural Time Series Models and the
// Kalman Filter, 1989, 3.4): linear in the views. What is considered enters as estimated with its u as prior, and what
// is held of target scope with one that the likelihood chooses: smooth errors that the model leaves out and noise
// of neighbours look alike, and neither may pass for the other.
//
// Where the likelihood ratio against rho = 0 is above 16 (p = 6e-5) and rho above 0.1 - with those smooth errors in
// both, if they alone explain more than the correlation alone - sets u and `neighbour` of these quantities, weighs the
// problem with them: kNoise. Weights stay those of independent views: for regressors as smooth as these they lose
// nothing (Grenander and Rosenblatt, Statistical Analysis of Stationary Time Series, 1957, ch. 7); u is K V K' with the
// V that was found. The degrees of freedom of the variances, and with them k, allow for the fewer independent views and
// for rho itself.
//
// Else nothing is changed: kSmooth where smooth errors explain the residuals, by the same ratio; kTooSlow where so few
// independent stretches are left (below 5 in all) that it is no noise any more; kNone also where views have more than
// 12 rows.
NeighboursFound EstimateNeighbours(Problem* problem, const Estimate& at, Variances* variances);

// What neighbours that err alike add to the covariance of sums over the whitened rows of a target: C'VC - C'C, C =
// columns (rows x sums), V the covariance of those rows, whose blocks of single views are the identity. linear: of the
// views.
Eigen::MatrixXd AcrossNeighbours(const Problem& problem, const Estimate& fit, const Linearization& linear,
                                 size_t target, const Eigen::MatrixXd& columns);

}  // namespace scancal
