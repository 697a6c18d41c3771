// What the commands that calibrate share.
#pragma once
#include <string>
#include <vector>
#include "models/scanner.h"

namespace scancal {

// Calibrates the one argument DATASET, writes calibration.json below --out, prints the result; returns the exit code.
int CalibrateAndReport(const std::vector<std::string>& arguments, const RefineChoice& choice);

// That a flag of this name asks for a sensible number of trials.
Result<void> CheckTrials(const std::string& flag, int trials);

}  // namespace scancal
