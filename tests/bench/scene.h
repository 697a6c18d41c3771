// The data of the comparisons: three placements, three million points in memory, and the same compressed.
#pragma once
#include <string>
#include <vector>
#include "models/turntable.h"
#include "models/turntable/compress.h"
#include "models/turntable/search.h"
#include "models/turntable/simulate.h"
#include "solver/refine.h"

namespace scancal::bench {

using turntable::Placement, turntable::PlaneStorey, turntable::SimulatedPlacement, turntable::SimulatedProfile;

// 3 x 1000 profiles of 1000 points, white noise of 0.05 mm; M and N not on a node of the grid.
turntable::Scene LargeScene();

std::vector<Placement> Compress(const std::vector<SimulatedPlacement>& points);

std::vector<PlaneStorey> Storeys(const std::vector<Placement>& placements);

// Where every joint fit starts, on either side: the orthogonal grid minimum at step 1, planes by total least squares.
struct Start {
  double M = 0, N = 0;
  std::vector<turntable::Model::Target> planes;  // normal, distance, e1, e2; no views
};
Start SearchStart(const std::vector<Placement>& placements);

Problem BuildProblem(const std::vector<Placement>& placements, const Start& start,
                     turntable::Model::Residuals residuals);
Estimate StartOf(const Problem& problem, const Start& start);

}  // namespace scancal::bench
