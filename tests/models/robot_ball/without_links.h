#pragma once
#include "models/robot_ball.h"

namespace scancal::robot_ball {

// Poses of the flange that the controller gives, in place of links.
inline Measurements WithoutLinks(Measurements data) {
  for (Station& station : data.stations)
    for (Model::View& view : station.views) {
      view.base_from_flange = BaseFromFlange(data.links, view.joints);
      view.joints.clear();
    }
  data.links.clear();
  data.check.clear();
  return data;
}

}  // namespace scancal::robot_ball
