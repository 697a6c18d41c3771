#include "models/robot_ball/pose_planner.h"
#include <cmath>
#include "io/units.h"
#include "models/robot_ball/inverse_kinematics.h"
#include "models/robot_ball/kr10.h"

namespace scancal {
namespace {

bool WithinLimits(const std::vector<double>& joints) {
  const auto limits = Kr10Limits();
  for (size_t k = 0; k < limits.size(); ++k)
    if (!(joints[k] >= limits[k].least && joints[k] <= limits[k].most)) return false;
  return true;
}

}  // namespace

std::vector<double> PosePlanner::Joints(const Eigen::Isometry3d& base_from_scanner, Random* random) const {
  constexpr int kStarts = 3;
  const Eigen::Isometry3d base_from_flange = base_from_scanner * flange_from_scanner_.inverse();
  const Eigen::Vector3d& p = base_from_flange.translation();
  for (int k = 0; k < kStarts; ++k) {
    std::vector<double> start = {std::atan2(p.y(), p.x()), -70 * kDegree, 0, 0, 60 * kDegree, 0};
    for (const size_t wrist : {3, 5}) start[wrist] = (2 * random->Uniform() - 1) * 90 * kDegree;
    std::optional<std::vector<double>> joints = JointsFor(links_, base_from_flange, start);
    if (joints && WithinLimits(*joints)) return *std::move(joints);
  }
  return {};
}

Eigen::Vector3d DrawWithin(const Eigen::Vector3d& limit, Random* random) {
  Eigen::Vector3d drawn;
  for (int i = 0; i < 3; ++i) drawn[i] = limit[i] * (2 * random->Uniform() - 1);
  return drawn;
}

Eigen::Isometry3d DrawPose(const Eigen::Isometry3d& straight, const PoseSpread& spread, Random* random) {
  const Eigen::Vector3d turn = DrawWithin(spread.turn, random), shift = DrawWithin(spread.shift, random);
  return straight * Eigen::Translation3d(shift) * Eigen::AngleAxisd(turn.x(), Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(turn.y(), Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(turn.z(), Eigen::Vector3d::UnitZ());
}

}  // namespace scancal
