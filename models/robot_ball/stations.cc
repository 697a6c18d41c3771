#include "models/robot_ball/stations.h"
#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include "io/message.h"
#include "models/parts/median.h"

namespace scancal {
namespace {

constexpr double kRounding_mm = 1e-9;  // of centres fitted to exact points

double SizeOf(const Eigen::Matrix3d& covariance) { return std::sqrt(covariance.trace() / 3); }

double MedianSize(const Observations& observations) {
  std::vector<double> sizes;
  for (const SeenCentre& seen : observations.seen)
    if (const double size = SizeOf(seen.covariance); size > 0) sizes.push_back(size);
  const double median = Median(std::move(sizes));
  return median > kRounding_mm ? median : 0;
}

Eigen::Matrix3d SquareRoot(const Eigen::Matrix3d& covariance) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).operatorSqrt();
}

std::vector<std::string> NamesOf(const PoseTable& poses) {
  std::vector<std::string> names;
  for (const Station& station : poses.stations)
    for (const RobotBall::View& view : station.views) names.push_back(view.name);
  return names;
}

Error SeenTwice(const Observations& observations, size_t row) {
  size_t first = 0;
  while (observations.Pose(first) != observations.Pose(row) || observations.Ball(first) != observations.Ball(row))
    ++first;
  return observations.table.Wrong(
      row, "ball",
      fmt::format("found {} again in pose {} (it stands also at {}), expected each ball once; name one of them as the "
                  "ball that it is, or remove it",
                  Quoted(observations.Ball(row)), Quoted(observations.Pose(row)), observations.table.Place(first)));
}

}  // namespace

double UsualNoise(const Observations& observations, double declared) {
  return declared > 0 ? declared : MedianSize(observations);
}

Result<void> AttachBalls(const Observations& observations, const std::vector<std::string>& balls,
                         const std::string& where, double declared_noise, PoseTable* poses) {
  std::unordered_map<std::string, int> indices;
  for (const std::string& ball : balls) indices.try_emplace(ball, static_cast<int>(indices.size()));
  const double unit = observations.fitted ? MedianSize(observations) : UsualNoise(observations, declared_noise);
  for (size_t row = 0; row < observations.seen.size(); ++row) {
    const std::string &pose_name = observations.Pose(row), &ball_name = observations.Ball(row);
    const auto place = poses->places.find(pose_name);
    if (place == poses->places.end())
      return observations.table.Wrong(row, "pose",
                                      "found " + Quoted(pose_name) + ", which " + poses->table.name() +
                                          " does not have" + Suggestion(pose_name, NamesOf(*poses)));
    const auto ball = indices.find(ball_name);
    if (ball == indices.end())
      return observations.table.Wrong(
          row, "ball",
          "found " + Quoted(ball_name) + ", which " + where + " does not have" + Suggestion(ball_name, balls));
    std::vector<RobotBall::SeenBall>& view = poses->View(place->second).balls;
    for (const RobotBall::SeenBall& other : view)
      if (other.sphere == ball->second) return SeenTwice(observations, row);
    RobotBall::SeenBall& added = view.emplace_back();
    added.sphere = ball->second;
    added.centre = observations.seen[row].centre;
    const Eigen::Matrix3d& covariance = observations.seen[row].covariance;
    if (unit > 0 && SizeOf(covariance) > 0) added.spread = SquareRoot(covariance) / unit;
  }
  return {};
}

std::vector<Station> TakeSeenStations(PoseTable* poses, std::vector<std::string>* warnings) {
  std::vector<Station> stations;
  std::vector<std::string> empty;
  for (Station& station : poses->stations) {
    Station kept{station.name, {}};
    for (RobotBall::View& view : station.views) {
      if (view.balls.empty()) empty.push_back(view.name);
      else kept.views.push_back(std::move(view));
    }
    if (!kept.views.empty()) stations.push_back(std::move(kept));
  }
  if (!empty.empty())
    warnings->push_back(fmt::format("{}: no ball was seen from {} of its poses, which are left out: {}",
                                    poses->table.name(), empty.size(), Listed(empty)));
  return stations;
}

}  // namespace scancal
