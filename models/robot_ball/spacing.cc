#include "models/robot_ball/spacing.h"
#include "models/robot_ball/hand_eye.h"

namespace scancal {

std::vector<double> SpacingErrors(const RobotData& data, const RobotSetup& setup) {
  const auto in_base = [&](const RobotBall::View& view) -> Eigen::Vector3d {
    return BaseFromScanner(data, setup, view) * view.balls[0].centre;
  };
  std::vector<double> errors;
  for (const CheckLength& check : data.check)
    errors.push_back((in_base(check.first_pose) - in_base(check.second_pose)).norm() - check.distance);
  return errors;
}

}  // namespace scancal
