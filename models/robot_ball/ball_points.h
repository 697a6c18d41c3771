// Centres of balls from points on them.
#pragma once
#include <filesystem>
#include "models/robot_ball/observations.h"

namespace scancal {

// Reads the file of every row and sets centre and covariance. Refused: a sphere that the points do not determine, a
// declared diameter that they contradict, points of one laser line (a circle, which leaves the centre two-fold).
Result<void> FitBalls(const std::filesystem::path& folder, const Units& units, double ball_diameter,
                      Observations* observations);

}  // namespace scancal
