// What calibration.json holds of uncertainties, read back: roles and u of the parameters, covariance, budget, volume.
#pragma once
#include <string>
#include "io/json_file.h"
#include "io/result.h"
#include "solver/calibration.h"

namespace scancal {

// The parameters' names and values are in `calibration`. Old files lack some keys: those fields stay empty. null is not
// a number, or infinite for degrees of freedom. file: for messages.
Result<void> ReadUncertainties(const Json& json, const std::string& file, Calibration* calibration);

}  // namespace scancal
