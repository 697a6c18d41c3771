// What the figures of a robot's result need.
#pragma once
#include "models/robot_ball/robot_fit.h"
#include "solver/calibration.h"

namespace scancal {

// Of every station: residual tables "poses" (named; with the number of balls and the rms of their residuals'
// coordinates) and "balls" (named; in the scanner's frame, without weights), and the scene in the base: "outline", the
// artifact's balls where the station holds them, and "views", from the scanner to the mean of the balls seen.
// Parameters get their nominal number.
void AddRobotFigures(const RobotData& data, const RobotFit& fit, Calibration* calibration);

}  // namespace scancal
