// The plane on which most profiles of a placement lie, whatever the others see.
#pragma once
#include <Eigen/Core>
#include <vector>
#include "models/turntable/profile.h"

namespace scancal {

// Farther than this many median distances is off the plane.
inline constexpr double kOffPlane = 6;

struct RobustPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ(), through = Eigen::Vector3d::Zero();
  std::vector<bool> off;  // per profile: its rms distance is more than kOffPlane times the median
  double Distance(const Eigen::Vector3d& p) const { return normal.dot(p - through); }
};

// Least median of squares over pairs of profiles, then total least squares on those that are not off. Up to 40 % of the
// profiles may see something else. system: near the truth; an error there bends the plane and widens the median.
// Fewer than six profiles are never off.
RobustPlane FitRobustPlane(const std::vector<Profile>& profiles, const turntable::System& system);

}  // namespace scancal
