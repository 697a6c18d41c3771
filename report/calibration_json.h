// calibration.json: the result, kept for years. Stable keys; others may be added.
#pragma once
#include <string>
#include "io/json_file.h"
#include "io/result.h"
#include "solver/calibration.h"

namespace scancal {

Json ToJson(const Calibration& calibration);  // "data" is left to the scanner
// What a later command needs of it: model, status, parameters, inputs, Monte Carlo, and what uncertainty_json.h reads.
// file: for messages.
Result<Calibration> CalibrationFromJson(const Json& json, const std::string& file);

}  // namespace scancal
