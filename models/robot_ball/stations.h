// Poses and what was seen from them, put together.
#pragma once
#include <string>
#include <vector>
#include "models/robot_ball/observations.h"
#include "models/robot_ball/poses.h"

namespace scancal {

// What SeenBall::spread is relative to, mm: what was declared (0: nothing) or else the median of what is known of the
// centres themselves; 0 if neither.
double UsualNoise(const Observations& observations, double declared);

// Gives every view its balls, in the order of the lines; SeenBall::sphere is the place in `balls`. Refused: a pose that
// is not in the table, a ball that is not among `balls` (those of `where`), a ball twice in a pose. Of centres fitted
// to points only the shape and relative size of the covariance counts where a noise is declared: neighbouring points
// err alike, which the fit does not know.
Result<void> AttachBalls(const Observations& observations, const std::vector<std::string>& balls,
                         const std::string& where, double declared_noise, PoseTable* poses);

// Moves the stations out of the table, without the poses that saw no ball, which are warned of, and without stations
// that have no other.
std::vector<Station> TakeSeenStations(PoseTable* poses, std::vector<std::string>* warnings);

}  // namespace scancal
