#include "models/robot_ball/inverse_kinematics.h"
#include <ceres/jet.h>
#include <glog/logging.h>
#include <Eigen/LU>
#include <algorithm>
#include <array>

namespace scancal {
namespace {

constexpr int kJoints = 6;
using Jet = ceres::Jet<double, kJoints>;
using Vector6 = Eigen::Matrix<double, kJoints, 1>;

struct Motion {  // of the flange; mm, rad
  Vector6 to_go;
  Eigen::Matrix<double, 6, kJoints> by_joints;
};

Motion MotionTo(const Eigen::Isometry3d& target, const std::vector<Link>& links, const std::vector<double>& joints) {
  ChainFrame<Jet> flange = MakeChainFrame<Jet>(Eigen::Isometry3d::Identity());
  std::array<Jet, kLinkNumbers * kJoints> errors;
  errors.fill(Jet(0));
  for (int k = 0; k < kJoints; ++k) errors[kLinkNumbers * k].v[k] = 1;  // theta turns like the joint
  MoveAlong(links, joints.data(), errors.data(), &flange);
  Motion motion;
  motion.by_joints.setZero();
  Eigen::Matrix3d rotation;
  for (int i = 0; i < 3; ++i) {
    motion.to_go[i] = target(i, 3) - flange.p[i].a;
    motion.by_joints.row(i) = flange.p[i].v;
  }
  int column = 0;
  for (const Jet* axis : {flange.x, flange.y, flange.z}) {  // the turn by a joint is sum of axis x d axis / 2
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      motion.by_joints.row(3 + i) += (axis[j].a * axis[k].v - axis[k].a * axis[j].v) / 2;
      rotation(i, column) = axis[i].a;
    }
    ++column;
  }
  const Eigen::AngleAxisd turn(target.linear() * rotation.transpose());
  motion.to_go.tail<3>() = turn.angle() * turn.axis();
  return motion;
}

}  // namespace

std::optional<std::vector<double>> JointsFor(const std::vector<Link>& links, const Eigen::Isometry3d& base_from_flange,
                                             const std::vector<double>& start) {
  CHECK_EQ(links.size(), kJoints);
  CHECK_EQ(start.size(), kJoints);
  constexpr int kSteps = 40;
  constexpr double kLongestStep_rad = 0.5, kReached = 1e-9;
  std::vector<double> joints = start;
  bool near = false;
  for (int k = 0; k < kSteps; ++k) {
    const Motion motion = MotionTo(base_from_flange, links, joints);
    Vector6 step = motion.by_joints.partialPivLu().solve(motion.to_go);
    const double longest = step.cwiseAbs().maxCoeff();
    if (!(longest < 1e6)) return std::nullopt;
    step *= std::min(1.0, kLongestStep_rad / longest);
    for (int i = 0; i < kJoints; ++i) joints[i] += step[i];
    if (near) return joints;  // one step more, for the last digits
    near = longest < kReached;
  }
  return std::nullopt;
}

}  // namespace scancal
