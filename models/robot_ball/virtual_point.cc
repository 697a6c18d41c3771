#include "models/robot_ball/virtual_point.h"
#include <Eigen/SVD>
#include <algorithm>
#include <optional>
#include <vector>
#include "models/robot_ball/hand_eye.h"

namespace scancal {
namespace {

using Eigen::Isometry3d, Eigen::Matrix3d, Eigen::Vector3d;
using SeenBall = RobotBall::SeenBall;
using View = RobotBall::View;

constexpr size_t kBallsOfThePoint = 4;

bool Sees(const View& view, int sphere) {
  return std::ranges::any_of(view.balls, [&](const SeenBall& ball) { return ball.sphere == sphere; });
}

int MostSeen(const std::vector<View>& views, size_t spheres) {
  std::vector<int> seen(spheres);
  for (const View& view : views)
    for (const SeenBall& ball : view.balls) ++seen[ball.sphere];
  return static_cast<int>(std::ranges::max_element(seen) - seen.begin());
}

std::vector<int> SeenInAll(const std::vector<View>& views, size_t spheres) {
  std::vector<int> common;
  for (int k = 0; k < static_cast<int>(spheres) && common.size() < kBallsOfThePoint; ++k)
    if (std::ranges::all_of(views, [&](const View& view) { return Sees(view, k); })) common.push_back(k);
  return common;
}

Vector3d Barycentre(const View& view, const std::vector<int>& of) {
  Vector3d sum = Vector3d::Zero();
  for (const SeenBall& ball : view.balls)
    if (std::ranges::find(of, ball.sphere) != of.end()) sum += ball.centre;
  return sum / static_cast<double>(of.size());
}

// The poses that see one point, with it alone; they leave `views`.
std::vector<View> TakeOnePoint(std::vector<View>* views, size_t spheres) {
  std::vector<View> taken = *views;
  if (SeenInAll(taken, spheres).empty())
    std::erase_if(taken, [most = MostSeen(taken, spheres)](const View& view) { return !Sees(view, most); });
  const std::vector<int> common = SeenInAll(taken, spheres);
  std::erase_if(*views, [&](const View& view) { return Sees(view, common[0]); });
  for (View& view : taken) view.balls = {{0, Barycentre(view, common)}};
  return taken;
}

struct Move {  // of the flange, and of the point as the scanner sees it
  Vector3d flange = Vector3d::Zero(), point = Vector3d::Zero();
};

// The poses from `first` on that have its orientation; they leave `poses`.
std::vector<Move> TakeTranslating(const RobotData& data, std::vector<View>* poses) {
  constexpr double kSameOrientation_rad = 1e-4;
  const Isometry3d first = BaseFromScanner(data, {}, poses->front());
  std::vector<Move> moves;
  std::erase_if(*poses, [&](const View& view) {
    const Isometry3d flange = BaseFromScanner(data, {}, view);
    const bool same = Eigen::AngleAxisd(first.linear().transpose() * flange.linear()).angle() < kSameOrientation_rad;
    if (same) moves.push_back({-(first.linear().transpose() * flange.translation()), view.balls[0].centre});
    return same;
  });
  Move mean;
  for (const Move& move : moves) mean.flange += move.flange, mean.point += move.point;
  for (Move& move : moves) {
    move.flange -= mean.flange / static_cast<double>(moves.size());
    move.point -= mean.point / static_cast<double>(moves.size());
  }
  return moves;
}

// Eq. (7); none if no poses translate in two directions.
std::optional<Matrix3d> RotationOfTranslating(const RobotData& points) {
  Matrix3d sum = Matrix3d::Zero();
  for (const Station& station : points.stations)
    for (std::vector<View> left = station.views; !left.empty();)
      for (const Move& move : TakeTranslating(points, &left)) sum += move.flange * move.point.transpose();
  const Eigen::JacobiSVD<Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vector3d& sigma = svd.singularValues();
  constexpr double kAlongOneLine = 1e-4;  // squared moves: a hundredth of the largest
  if (sigma[0] == 0 || sigma[1] < kAlongOneLine * sigma[0]) return std::nullopt;
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  return svd.matrixU() * Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}

}  // namespace

RobotData VirtualPoints(const RobotData& data) {
  RobotData points = data;
  points.spheres = {{"virtual point", Vector3d::Zero()}};
  points.check.clear();
  points.stations.clear();
  for (const Station& station : data.stations) {
    std::vector<View> left = station.views;
    std::erase_if(left, [](const View& view) { return view.balls.empty(); });
    while (!left.empty()) points.stations.push_back({station.name, TakeOnePoint(&left, std::ssize(data.spheres)), {}});
  }
  return points;
}

Result<RobotSetup> VirtualPointHandEye(const RobotData& data) {
  const RobotData points = VirtualPoints(data);
  const std::optional<Matrix3d> rotation = RotationOfTranslating(points);
  if (!rotation) return InitialHandEye(data);
  RobotSetup setup;
  setup.flange_from_scanner.linear() = *rotation;
  SCANCAL_ASSIGN_OR_RETURN(setup.flange_from_scanner.translation(), HandEyeTranslation(points, *rotation));
  setup.link_errors.resize(data.links.size());
  return setup;
}

}  // namespace scancal
