// The search's objective S over M and N, for figures.
#pragma once
#include <vector>
#include "models/turntable/plane_storey.h"
#include "solver/calibration.h"
#include "solver/grid_search.h"

namespace scancal {

// Eq. (15): the mean of the placements' rmse, mm.
double SAt(const std::vector<PlaneStorey>& storeys, double M, double N, PlaneFit fit);

// Calibration::surface, columns M, N, S (orthogonal), mm, N faster: "search", the nodes of the box thinned to at most
// 61 x 61, its first and last ones included, of the system as declared; "near", 41 x 41 in a square about the refined
// value that holds 3 U, and the minimum of the grid unless it is farther than three steps, of the system as found. A
// parameter that is not estimated has one node. Parameters and grid must be in place; where U is not finite there is no
// "near".
void AddSurface(const GridBox& box, const std::vector<PlaneStorey>& declared, const std::vector<PlaneStorey>& found,
                Calibration* calibration);

}  // namespace scancal
