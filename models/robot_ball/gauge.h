// One robot, many tables of links: what a calibration can tell of the true one.
#pragma once
#include <Eigen/Geometry>
#include <vector>
#include "models/robot_ball/measured.h"

namespace scancal {

struct Gauged {
  RobotSetup setup;
  Eigen::Isometry3d base_from_true_base;  // the base that these numbers are told in
};

// The numbers that a calibration with the default roles of the links finds of a robot with these errors: theta_1 and
// d_1 go into the base, all of the last link into the hand-eye, d before a parallel axis into the next d. Every ball is
// seen as before; exact but for the last, where a beta before it is not zero (second order).
Gauged InDefaultGauge(const std::vector<Link>& nominal, const RobotSetup& truth);

}  // namespace scancal
