#include "models/robot_ball/spacing.h"
#include <algorithm>
#include <cmath>
#include "models/robot_ball/hand_eye.h"

namespace scancal {

Spacing SpacingErrors(const RobotData& data, const RobotSetup& setup) {
  const auto in_base = [&](const RobotBall::View& view) -> Eigen::Vector3d {
    return BaseFromScanner(data, setup, view) * view.balls[0].centre;
  };
  Spacing spacing;
  for (const CheckLength& check : data.check) {
    const double error = (in_base(check.first_pose) - in_base(check.second_pose)).norm() - check.distance;
    spacing.errors.push_back(error);
    spacing.max = std::max(spacing.max, std::abs(error));
    spacing.mean += std::abs(error) / static_cast<double>(data.check.size());
  }
  return spacing;
}

}  // namespace scancal
