// Are views independent of each other, as everything here counts them?
#pragma once
#include "solver/linearize.h"

namespace scancal {

// Correlation between neighbouring views of a target, pooled over targets and over everything of view scope: with z_v
// the whitened residual of view v along the effects of such quantities, sum z_v . z_v+1 / sum |z_v|^2. The standard
// error is that of independent pairs, from their own spread: effects may look alike.
struct Neighbours {
  double correlation = 0, standard_error = 0;
};
Neighbours CorrelationOfNeighbours(const Problem& problem, const Estimate& fit, const Linearization& linear);

}  // namespace scancal
