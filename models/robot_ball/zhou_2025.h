// The published method: Zhou et al., Sensors 2025, 25, 4661.
#pragma once
#include "io/result.h"
#include "models/robot_ball/measured.h"

namespace scancal {

// Measured centres corrected (eqs. (8)-(20), AdjustCentres), first hand-eye from virtual points (eqs. (5)-(7),
// VirtualPointHandEye), then hand-eye and link errors from distances (eqs. (21)-(32), IdentifyByDistances). Kept as a
// baseline: all distances weigh alike, and repeatability enters them unseen. Where all balls are of the same noise, it
// is no better than Mu2017 on simulated data (spacing errors within 5 %): the many distances average what the
// correction takes away. It is better where some balls are worse, and SeenBall::spread says so.
Result<RobotSetup> Zhou2025(const RobotData& data);

}  // namespace scancal
