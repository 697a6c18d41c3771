// Hand-eye and link errors from distances in the base: eqs. (21)-(32) of Zhou et al. 2025.
#pragma once
#include "io/result.h"
#include "models/robot_ball/measured.h"

namespace scancal {

enum class Identified { kHandEye, kHandEyeAndLinks };

// Levenberg-Marquardt (MINPACK's, by QR) over the hand-eye and the link errors that RobotBall estimates by default,
// from `start`; what is held stays as it is there. Balls a and b seen from two poses of a station give (eq. (30))
//
//     |p_a - p_b| - l_ab,        l_ab the CMM's,
//
// p in the base; the same ball seen twice gives p_a - p_b, three numbers, for the norm has no derivative at zero. Pairs
// within one pose say nothing of the robot. All have one weight. Derivatives are exact (dual numbers through the
// chain).
//
// Pairs: each pose with the 16 that follow it at its station, the last with the first: up to 33 poses these are all
// pairs; and all their balls. Time and memory grow with poses x 16 x balls^2, 0.2 kB each.
//
// Errors: fewer distances than unknowns; no minimum reached. What the distances do not determine stays near the start.
// One distance enters many pairs, and they are not independent: not the best estimate, and no uncertainty comes of it.
Result<RobotSetup> IdentifyByDistances(const RobotData& data, const RobotSetup& start, Identified identified);

}  // namespace scancal
