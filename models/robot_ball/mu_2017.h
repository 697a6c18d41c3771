// Mu et al., Opt. Eng. 2017, 56, 054103, as Zhou et al. 2025 compare with it.
#pragma once
#include "io/result.h"
#include "models/robot_ball/measured.h"

namespace scancal {

// Hand-eye and link errors from distances (IdentifyByDistances), the measured centres as they are: Zhou2025 without its
// correction.
Result<RobotSetup> Mu2017(const RobotData& data);

}  // namespace scancal
