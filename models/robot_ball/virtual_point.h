// The published first hand-eye, from one virtual point: eqs. (5)-(7) of Zhou et al. 2025.
#pragma once
#include "io/result.h"
#include "models/robot_ball/measured.h"

namespace scancal {

// The data with one ball a pose: the barycentre of the four balls, or fewer, that all poses of its station see, eq.
// (5). Where no ball is seen in all poses, the poses that see the most seen ball have a point, and so on with the
// others: the station becomes several of its name.
RobotData VirtualPoints(const RobotData& data);

// flange_from_scanner with nominal links, from the virtual points P_j. Poses of one orientation (within 1e-4 rad) at a
// station only translate, by T_j - T_1 of the base: for them (eq. (7))
//
//     R_SE (P_1 - P_j) = R_E^-1 (T_j - T_1),
//
// differences to the mean in place of the first. R_SE is the rotation (det +1) that fits best, by SVD; two directions
// of movement suffice. T_SE follows by linear least squares, eq. (6), from the poses that turn.
//
// Few data sets hold poses that only translate; without them, or if they move along one line, InitialHandEye takes
// over, with all balls.
Result<RobotSetup> VirtualPointHandEye(const RobotData& data);

}  // namespace scancal
