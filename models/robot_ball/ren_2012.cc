#include "models/robot_ball/ren_2012.h"
#include <vector>
#include "models/robot_ball/distance_identification.h"
#include "models/robot_ball/hand_eye.h"
#include "models/robot_ball/virtual_point.h"

namespace scancal {
namespace {

using View = RobotBall::View;

Station OnlySphere(Station station, int sphere) {
  for (View& view : station.views)
    std::erase_if(view.balls, [&](const RobotBall::SeenBall& ball) { return ball.sphere != sphere; });
  std::erase_if(station.views, [](const View& view) { return view.balls.empty(); });
  return station;
}

Station MostSeenSphere(const RobotData& data) {
  Station most;
  for (const Station& station : data.stations)
    for (int k = 0; k < std::ssize(data.spheres); ++k)
      if (Station one = OnlySphere(station, k); one.views.size() > most.views.size()) most = std::move(one);
  return most;
}

}  // namespace

Result<RobotSetup> Ren2012(const RobotData& data) {
  RobotData one = data;
  one.stations = {MostSeenSphere(data)};
  Result<RobotSetup> first = VirtualPointHandEye(one);
  if (!first.ok()) first = InitialHandEye(data);
  if (!first.ok()) return first;
  return IdentifyByDistances(one, *first, Identified::kHandEye);
}

}  // namespace scancal
