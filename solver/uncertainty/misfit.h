// What the model leaves out, asked of the residuals.
#pragma once
#include <utility>
#include <vector>
#include "solver/calibration.h"
#include "solver/linearize.h"

namespace scancal {

// Every source of system or target scope that was not estimated (held, or considered with its u), in the order of the
// quantities, tested by its score (Rao 1948): with B its columns dr/dq, free of what the estimated quantities explain,
// m = -(B'B)^-1 B'r is what a fit would give it; its covariance is (B'B)^-1 from the noise, and what everything that
// was considered, itself among it, makes of m. F = m' (cov m)^-1 m / dof1; p after Bonferroni, for all that were
// tested. The problem is weighed with its noise; linear: of the views, at the fit. noise_dof: degrees of freedom of
// that noise.
std::vector<MisfitTest> TestMisfits(const Problem& problem, const Estimate& fit, const Linearization& linear,
                                    double noise_dof);

// Did something change in between? From some view on, in the order of time, these quantities may have had other values:
// their columns from there on are tested as above, at every place that leaves a twentieth of the views on either side,
// and four (Andrews 1993, Econometrica 61, 821: nearer to the ends a few outliers decide); what was considered counts
// as noise. Views are independent. order: target and view.
struct Change {
  size_t place = 0;           // in `order`: the first view that is not as before
  double F = 0, dof1 = 0;     // of the most significant place
  double p = 1;               // after Bonferroni, for all places that were tried
  std::vector<double> size;   // per quantity: the step
  std::vector<double> moves;  // per estimated parameter: what the step has moved it by
};
Change FindChange(const Problem& problem, const Estimate& fit, const Linearization& linear, double noise_dof,
                  const std::vector<std::pair<size_t, size_t>>& order, const std::vector<int>& quantities);

// Are views independent of each other, as everything here counts them? Correlation between neighbouring views of a
// target, pooled over targets and over everything of view scope: with z_v the whitened residual of view v along the
// effects of such quantities, sum z_v . z_v+1 / sum |z_v|^2 (Box and Jenkins, Time Series Analysis, 1970, 2.1, at lag
// 1). The standard error is that of independent pairs, from their own spread: effects may look alike.
struct Neighbours {
  double correlation = 0, standard_error = 0;
  // The largest of sum z_v . (z_v-1 + rho z_v-2 + rho^2 z_v-3 ...) for rho of 0, 0.8 and 0.95 and each of those effects
  // alone, in standard deviations of independent views: what wanders slowly, but little, shows there.
  double wandering = 0;
  bool IsSignificant() const;  // 4 standard errors, and makes u too small by a tenth
  bool IsSuspected() const;    // or wanders by 4 standard deviations
};
Neighbours CorrelationOfNeighbours(const Problem& problem, const Estimate& fit, const Linearization& linear);

}  // namespace scancal
