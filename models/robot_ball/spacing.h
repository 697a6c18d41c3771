// The error of sphere spacings that took no part in the calibration, after VDI/VDE 2634-3.
#pragma once
#include <vector>
#include "models/robot_ball/measured.h"

namespace scancal {

struct Spacing {
  std::vector<double> errors;  // |p_a - p_b| in the base minus the CMM's distance, mm, one per RobotData::check
  double max = 0, mean = 0;    // of their absolute values; 0 without any
};

Spacing SpacingErrors(const RobotData& data, const RobotSetup& setup);

}  // namespace scancal
