#include "models/robot_ball/verdicts.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include "models/parts/median.h"
#include "models/robot_ball/hand_eye.h"

namespace scancal {
namespace {

constexpr double kGross = 5;  // times the median of all poses: noise of a few balls reaches two
constexpr size_t kNamed = 3;  // poses
constexpr double kOtherUnit = 0.1;

struct OffPose {
  std::string station, pose;
  double rms = 0;  // mm, of its balls from the artifact
};

std::vector<OffPose> ByPose(const RobotData& data, const RobotFit& fit) {
  const RobotSetup setup = fit.Setup();
  std::vector<OffPose> poses;
  for (size_t t = 0; t < data.stations.size(); ++t) {
    const Eigen::Isometry3d base_from_artifact = fit.BaseFromArtifact(t);
    for (const RobotBall::View& pose : data.stations[t].views) {
      const Eigen::Isometry3d base_from_scanner = BaseFromScanner(data, setup, pose);
      double squares = 0;
      for (const RobotBall::SeenBall& ball : pose.balls)
        squares +=
            (base_from_scanner * ball.centre - base_from_artifact * data.spheres[ball.sphere].centre).squaredNorm();
      poses.push_back({data.stations[t].name, pose.name,
                       std::sqrt(squares / static_cast<double>(std::max<size_t>(1, pose.balls.size())))});
    }
  }
  return poses;
}

void JudgePoses(const RobotData& data, const RobotFit& fit, Calibration* result) {
  constexpr double kRounding_mm = 1e-5;
  std::vector<OffPose> poses = ByPose(data, fit);
  std::vector<double> all;
  for (const OffPose& pose : poses) all.push_back(pose.rms);
  const double usual = std::max(Median(all), kRounding_mm);
  std::erase_if(poses, [&](const OffPose& pose) { return pose.rms <= kGross * usual; });
  std::sort(poses.begin(), poses.end(), [](const OffPose& a, const OffPose& b) { return a.rms > b.rms; });
  // One bad pose pulls its neighbours with it.
  std::erase_if(
      poses, [&, worst = poses.empty() ? 0 : poses.front().rms](const OffPose& pose) { return pose.rms < worst / 2; });
  for (size_t k = 0; k < poses.size() && k < kNamed; ++k)
    result->unreliable.push_back(fmt::format(
        "pose {} of station {}: its balls lie {:.2g} mm off, {:.2g} times the median of all poses; check its "
        "joint angles and balls, or leave it out",
        poses[k].pose, poses[k].station, poses[k].rms, poses[k].rms / usual));
}

void JudgeCheck(const RobotData& data, Calibration* result) {
  const LengthCheck& check = result->check;
  for (size_t k = 0; k < check.after.size(); ++k) {
    if (std::abs(check.after[k]) <= kOtherUnit * data.check[k].distance) continue;
    result->unreliable.push_back(
        fmt::format("check: {}: measured {:.6g} mm, known as {:.6g} mm: another unit, or other "
                    "balls?",
                    check.names[k], data.check[k].distance + check.after[k], data.check[k].distance));
    return;
  }
  const double before = SizeOfErrors(check.before).mean, after = SizeOfErrors(check.after).mean;
  if (after > before)
    result->unreliable.push_back(fmt::format(
        "check: the known lengths are off by {:.2g} mm on average, more than with the nominal robot ({:.2g} mm)", after,
        before));
}

}  // namespace

void JudgeRobot(const RobotData& data, const RobotFit& fit, Calibration* result) {
  JudgePoses(data, fit, result);
  JudgeCheck(data, result);
}

}  // namespace scancal
