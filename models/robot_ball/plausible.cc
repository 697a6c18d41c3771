#include "models/robot_ball/plausible.h"
#include <fmt/format.h>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <set>
#include "io/message.h"
#include "io/units.h"
#include "models/parts/declared_links.h"

namespace scancal {
namespace {

constexpr size_t kFewestBalls = 3;
constexpr double kLeastTurn_rad = 0.0175;  // one degree, rms

Eigen::Isometry3d FlangeOf(const RobotData& data, const RobotBall::View& view) {
  return data.links.empty() ? view.base_from_flange : BaseFromFlange(data.links, view.joints);
}

Result<void> CheckReach(const RobotData& data, const std::string& where) {
  if (!data.links.empty()) return {};
  double reach = 0;
  for (const Station& station : data.stations)
    for (const RobotBall::View& view : station.views)
      reach = std::max(reach, view.base_from_flange.translation().norm());
  if (reach >= kLeastReach_mm && reach <= kLargestReach_mm) return {};
  return Error{
      fmt::format("{}: the flange comes {:.3g} mm away from the base, expected {} mm to {} mm; see units: length, "
                  "or name the columns x_mm, x_m or x_um",
                  where, reach, kLeastReach_mm, kLargestReach_mm)};
}

// What the poses of each station turn v by, rms over the poses: singular values of (R_i - R_1) v.
Result<void> CheckTurns(const RobotData& data, const std::string& where, std::vector<std::string>* warnings) {
  std::vector<Eigen::Matrix3d> turns;
  for (const Station& station : data.stations) {
    const Eigen::Matrix3d first = FlangeOf(data, station.views.front()).linear();
    for (size_t k = 1; k < station.views.size(); ++k)
      turns.push_back(FlangeOf(data, station.views[k]).linear() - first);
  }
  Eigen::MatrixX3d rows(3 * std::ssize(turns), 3);
  for (size_t k = 0; k < turns.size(); ++k) rows.middleRows<3>(3 * static_cast<Eigen::Index>(k)) = turns[k];
  const Eigen::JacobiSVD<Eigen::MatrixX3d> svd(rows, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::Vector3d turn = svd.singularValues() / std::sqrt(static_cast<double>(turns.size()));
  if (turn[0] < kLeastTurn_rad)
    return Error{
        fmt::format("{}: within each station the flange turns by {:.2g} deg only, which leaves the translation "
                    "of the hand-eye open; expected poses that turn about two axes, by tens of degrees",
                    where, turn[0] / kDegree)};
  if (turn[2] < kLeastTurn_rad) {
    const Eigen::Vector3d axis = svd.matrixV().col(2);
    warnings->push_back(
        fmt::format("{}: within each station the flange turns about one axis only, ({:.2f}, {:.2f}, {:.2f}) of its own "
                    "frame: along it the hand-eye is not determined; add poses that turn about another",
                    where, axis[0], axis[1], axis[2]));
  }
  return {};
}

Result<void> CheckStations(const RobotData& data, const std::string& where, std::vector<std::string>* warnings) {
  std::vector<std::string> once, few;
  for (const Station& station : data.stations) {
    std::set<int> balls;
    for (const RobotBall::View& view : station.views) {
      for (const RobotBall::SeenBall& ball : view.balls) balls.insert(ball.sphere);
      if (view.balls.size() < kFewestBalls) few.push_back(view.name);
    }
    if (balls.size() < kFewestBalls)
      return Error{
          fmt::format("{}: all poses of station {} together saw {} of the balls, expected {} or more: the pose "
                      "of the artifact is not determined; add balls, or remove the station",
                      where, Quoted(station.name), balls.size(), kFewestBalls)};
    if (station.views.size() == 1) once.push_back(station.name);
  }
  if (once.size() == data.stations.size())
    return Error{where +
                 ": every station was seen from one pose only, expected two or more: one pose says where the "
                 "artifact is, and nothing about robot and hand-eye"};
  if (!once.empty())
    warnings->push_back(
        fmt::format("{}: {} of {} stations were seen from one pose only, which says nothing about robot "
                    "and hand-eye: {}",
                    where, once.size(), data.stations.size(), Listed(once)));
  if (!few.empty())
    warnings->push_back(
        fmt::format("{}: {} poses saw less than {} balls, too few to place the artifact by themselves: {}", where,
                    few.size(), kFewestBalls, Listed(few)));
  return {};
}

}  // namespace

Result<void> CheckPlausible(const RobotData& data, const std::string& where, std::vector<std::string>* warnings) {
  SCANCAL_RETURN_IF_ERROR(CheckReach(data, where));
  SCANCAL_RETURN_IF_ERROR(CheckStations(data, where, warnings));
  return CheckTurns(data, where, warnings);
}

}  // namespace scancal
