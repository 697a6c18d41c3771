// What may go wrong with planes on a turntable, told by name.
#pragma once
#include "models/turntable/turntable_scanner.h"

namespace scancal {

// Before the fit: plates that determine nothing because all are perpendicular to the axis.
Result<void> CheckOrientations(const Quantities& quantities, const std::vector<Placement>& placements,
                               const std::vector<PlaneStorey>& storeys, const turntable::System& system);

// At the start of the refinement: plates that are seen edge-on.
Result<void> CheckIncidence(const std::vector<Placement>& placements, const turntable::System& system);

// After the fit: quantities without effect of their own.
Result<void> CheckDetermined(const TurntableFit& fit);

// Doubts about a computed result: minimum on the edge, parallel placements, a narrow sweep. grid: of a search that
// knows what was found besides M and N.
void JudgeTurntable(const GridBox& box, const std::vector<Placement>& placements, const GridResult& grid,
                    const TurntableFit& fit, Calibration* calibration);

}  // namespace scancal
