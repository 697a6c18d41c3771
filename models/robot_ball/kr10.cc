// The arm of the simulated experiment: its numbers, and joint angles that bring it somewhere.
#include <ceres/jet.h>
#include <glog/logging.h>
#include <algorithm>
#include <array>
#include <cmath>
#include "io/units.h"
#include "models/robot_ball/simulate.h"
#include "solver/dense.h"

namespace scancal::robot_ball {
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

bool WithinLimits(const std::vector<double>& joints) {
  constexpr double kLimits_deg[kJoints][2] = {{-170, 170}, {-190, 45},  {-210, 66},
                                              {-185, 185}, {-120, 120}, {-350, 350}};
  for (int k = 0; k < kJoints; ++k)
    if (!(joints[k] >= kLimits_deg[k][0] * kDegree && joints[k] <= kLimits_deg[k][1] * kDegree)) return false;
  return true;
}

}  // namespace

std::vector<Link> Kr10Links() {
  constexpr double kQuarter = 90 * kDegree;
  return {{0, 400, 25, -kQuarter, 0}, {0, 0, 560, 0, 0},       {0, 0, 35, -kQuarter, 0},
          {0, 515, 0, kQuarter, 0},   {0, 0, 0, -kQuarter, 0}, {0, 80, 0, 0, 0}};
}

std::vector<Link> PublishedLinkErrors() {
  std::vector<Link> errors = {{0.0206, 0.4539, 0.1428, 0.0074, 0},    {-0.0169, 0, -0.2632, 0.0022, 0.0079},
                              {0.0309, -0.2168, 0.0508, -0.0127, 0},  {-0.0407, 0.0687, 0.0268, 0.0014, 0},
                              {0.0274, -0.0832, -0.0034, -0.0137, 0}, {-0.0237, 0.1041, 0.0378, 0.0293, 0}};
  for (Link& link : errors) {
    link.theta *= kDegree;
    link.alpha *= kDegree;
    link.beta *= kDegree;
  }
  return errors;
}

Eigen::Isometry3d PublishedHandEye() {
  Eigen::Matrix3d printed;
  printed << 0.0171, 0.9998, 0.0053,  //
      0.9999, -0.0173, 0.0022,        //
      0.0003, 0.0056, -1.0001;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = NearestOrthogonal(printed);
  pose.translation() << 1.2874, 0.5842, 264.7846;
  return pose;
}

Eigen::Isometry3d DrawnHandEye() {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << 0, 1, 0,  //
      1, 0, 0,               //
      0, 0, -1;
  pose.translation() << 0, 0, 265;
  return pose;
}

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
    Vector6 step = SolveSquare(motion.by_joints, motion.to_go);
    const double longest = step.cwiseAbs().maxCoeff();
    if (!(longest < 1e6)) return std::nullopt;
    step *= std::min(1.0, kLongestStep_rad / longest);
    for (int i = 0; i < kJoints; ++i) joints[i] += step[i];
    if (near) return joints;  // one step more, for the last digits
    near = longest < kReached;
  }
  return std::nullopt;
}

std::vector<double> PlanJoints(const std::vector<Link>& links, const Eigen::Isometry3d& base_from_flange,
                               Random* random) {
  constexpr int kStarts = 3;
  const Eigen::Vector3d& p = base_from_flange.translation();
  for (int k = 0; k < kStarts; ++k) {
    std::vector<double> start = {std::atan2(p.y(), p.x()), -70 * kDegree, 0, 0, 60 * kDegree, 0};
    for (const size_t wrist : {3, 5}) start[wrist] = (2 * random->Uniform() - 1) * 90 * kDegree;
    std::optional<std::vector<double>> joints = JointsFor(links, base_from_flange, start);
    if (joints && WithinLimits(*joints)) return *std::move(joints);
  }
  return {};
}

}  // namespace scancal::robot_ball
