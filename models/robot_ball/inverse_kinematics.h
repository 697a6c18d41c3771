// Joint angles that bring the flange somewhere.
#pragma once
#include <Eigen/Geometry>
#include <optional>
#include <vector>
#include "models/parts/chain.h"

namespace scancal {

// Newton's method from `start` (rad, one a link) for an arm of six links, to rounding. None if it does not get there
// within a few dozen steps: out of reach, a singular posture, or a start on the wrong side.
std::optional<std::vector<double>> JointsFor(const std::vector<Link>& links, const Eigen::Isometry3d& base_from_flange,
                                             const std::vector<double>& start);

}  // namespace scancal
