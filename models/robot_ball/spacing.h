// The error of sphere spacings that took no part in the calibration, after VDI/VDE 2634-3.
#pragma once
#include <vector>
#include "models/robot_ball/measured.h"

namespace scancal {

// |p_a - p_b| in the base minus the CMM's distance, mm, one per RobotData::check.
std::vector<double> SpacingErrors(const RobotData& data, const RobotSetup& setup);

}  // namespace scancal
