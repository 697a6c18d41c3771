// Doubts about a result that need no knowledge of the scanner, in words.
#pragma once
#include "solver/calibrate.h"
#include "solver/uncertainty/jackknife.h"

namespace scancal {

// Adds to warnings what is worth knowing, to unreliable what forbids relying on the result: no convergence, too few
// views, targets that contradict each other, data that contradict a prior, and what the model leaves out if it is
// significant and moves a quantity by more than its u. With equal weights lack of fit is a warning only. noise_dof:
// degrees of freedom of what is known of the noise.
void AddDoubts(const Solution& solution, const Jackknife& jackknife, double noise_dof, Calibration* calibration);

}  // namespace scancal
