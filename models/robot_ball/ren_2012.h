// Ren, Yin, Zhu, Opt. Eng. 2012, 51, 114204, as Zhou et al. 2025 compare with it.
#pragma once
#include "io/result.h"
#include "models/robot_ball/measured.h"

namespace scancal {

// The hand-eye from a single sphere, links nominal: of the sphere that one station sees most often, the centre stands
// still in the base. First from eqs. (6)-(7), or from all balls (InitialHandEye) where the one sphere is too little to
// start from; then the least squares of its scatter, which does not know the artifact.
//
// Error: no sphere is seen twice, or the poses do not move enough for a start.
Result<RobotSetup> Ren2012(const RobotData& data);

}  // namespace scancal
