// Where profiler and plates stood, for figures.
#pragma once
#include <vector>
#include "models/turntable/placement.h"
#include "solver/calibration.h"

namespace scancal {

// Of a target, in the table frame: "outline", closed (the last corner is the first), the patch that was measured, its
// corners on the plane that was found (normal, distance); "views", of at most nine profiles evenly over the sweep, from
// the profiler's origin to the middle of what it saw. Everything else of the calibration must be in place.
void AddScene(const std::vector<Placement>& placements, Calibration* calibration);

}  // namespace scancal
