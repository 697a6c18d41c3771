// Doubts about a robot's calibration, in words.
#pragma once
#include "models/robot_ball/robot_fit.h"

namespace scancal {

// Unreliable: a pose whose balls lie far from where all others put them, by name (one wrong joint angle spoils links
// and hand-eye, and would pass as repeatability); known lengths that the calibration makes worse, or misses by a tenth.
void JudgeRobot(const RobotData& data, const RobotFit& fit, Calibration* result);

}  // namespace scancal
