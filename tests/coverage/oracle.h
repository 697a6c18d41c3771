// Who knows how the data were made: the narrowest interval that an honest estimate can state.
#pragma once
#include <Eigen/Core>
#include <vector>
#include "models/turntable/placement.h"
#include "models/turntable/simulate.h"

namespace scancal::coverage {

struct Oracle {             // of M, N; mm
  Eigen::Vector2d sigma;    // standard deviation of its estimate
  Eigen::Vector2d error;    // of its estimate from these data
};

// Generalised least squares of M, N and the planes with the true covariance of the profiles' lines: noise, what the
// first-order autoregressive process adds to offset and slope of a profile, jitter. Linearised at the truth, to first order.
// truth: what was simulated; seen: what reading left of it.
Oracle AskOracle(const TurntableScene& scene, const std::vector<SimulatedPlacement>& truth,
                 const std::vector<Placement>& seen);

}  // namespace scancal::coverage
