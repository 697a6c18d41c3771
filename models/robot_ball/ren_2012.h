// Ren, Yin, Zhu, Opt. Eng. 2012, 51, 114204, as Zhou et al. 2025 compare with it.
#pragma once
#include "io/result.h"
#include "models/robot_ball/measured.h"

namespace scancal {

// The hand-eye from a single sphere, links nominal: of the sphere that one station sees most often, the centre stands
// still in the base. First from eqs. (6)-(7), then the least squares of its scatter. The artifact is not needed.
//
// Error: no sphere is seen often enough, or the poses that see it do not move enough.
Result<RobotSetup> Ren2012(const RobotData& data);

}  // namespace scancal
