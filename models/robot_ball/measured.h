// What a robot's data set holds once it is read: mm, rad, no files.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include "models/robot_ball.h"

namespace scancal {

using Station = RobotBall::Target;  // base_from_artifact not set

// The distance of two balls, known from a CMM, seen in some pose each: not used in the calibration (`check:`).
struct CheckLength {
  std::string name;                         // of the pair, for tables
  RobotBall::View first_pose, second_pose;  // one ball each: balls[0]; may be the same pose
  double distance = 0, u = 0;               // mm
};

struct RobotData {
  std::vector<Link> links;  // none: the poses of the flange are given
  std::vector<RobotBall::Sphere> spheres;
  double u_spheres = 0;      // standard uncertainty of each coordinate of their centres, mm
  double ball_diameter = 0;  // mm; 0: not declared
  std::vector<Station> stations;
  std::vector<CheckLength> check;
  double usual_ball_noise = 0;  // mm: what RobotBall::SeenBall::spread is relative to; 0: nothing was declared
};

// What a method finds.
struct RobotSetup {
  Eigen::Isometry3d flange_from_scanner = Eigen::Isometry3d::Identity();
  std::vector<Link> link_errors;  // added to the nominal; one a link
};

}  // namespace scancal
