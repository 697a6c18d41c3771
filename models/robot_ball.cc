#include "models/robot_ball.h"

namespace scancal {
namespace {

constexpr const char* kAxes[] = {"x", "y", "z", "rx", "ry", "rz"};

}  // namespace

RobotBall::RobotBall(std::vector<Link> links, std::vector<Sphere> spheres)
    : links_(std::move(links)), spheres_(std::move(spheres)) {
  using enum Scope;
  const auto declare = [&](const std::string& name, int count, Scope scope, Role role, const char* source = "") {
    for (int k = 0; k < count; ++k)
      quantities_.push_back({name + "_" + kAxes[k], k < 3 ? Unit::kMm : Unit::kRad, scope, role, 0, 0, false, source});
  };
  declare("hand_eye", 6, kSystem, Role::kEstimate);
  declare("artifact", 6, kTarget, Role::kEstimate);
  declare("repeatability", 3, kView, Role::kEstimate, "repeatability");  // of these two `estimate` means their
  declare("ball", 3, kPoint, Role::kEstimate, "ball");                   // variance
  DeclareLinks(links_.size(), &quantities_);
  SetDefaultLinkRoles(links_, kLinks, &quantities_);
  for (const Sphere& sphere : spheres_) declare("sphere_" + sphere.name, 3, kSystem, Role::kHold, "artifact");
}

Eigen::Isometry3d PoseOf(const Eigen::Matrix<double, 6, 1>& numbers) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d turn = numbers.tail<3>();
  Eigen::Matrix3d rotation;
  ceres::AngleAxisToRotationMatrix(turn.data(), rotation.data());
  pose.linear() = rotation;
  pose.translation() = numbers.head<3>();
  return pose;
}

Eigen::Matrix<double, 6, 1> NumbersOf(const Eigen::Isometry3d& pose) {
  const Eigen::AngleAxisd turn(pose.linear());
  Eigen::Matrix<double, 6, 1> numbers;
  numbers << pose.translation(), turn.angle() * turn.axis();
  return numbers;
}

}  // namespace scancal
