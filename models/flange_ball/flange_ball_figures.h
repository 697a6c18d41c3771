// What the figures of a flange-ball's result need.
#pragma once
#include "models/flange_ball/flange_ball_fit.h"
#include "solver/calibration.h"

namespace scancal {

// Of every location of the tool: residual tables "poses" (with the number of the socket and the rms of the residual's
// coordinates) and "balls" (one a pose, the residual of FlangeBall: in the base, turned back by theta_1), and the scene
// in the base: "outline", the two sockets, and "views", from the flange to the ball. Parameters get their nominal
// number.
void AddFlangeBallFigures(const std::vector<Link>& nominal, const std::vector<FlangeBall::Target>& tools,
                          const Solution& solution, Calibration* calibration);

}  // namespace scancal
