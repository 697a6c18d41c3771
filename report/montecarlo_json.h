// The key "montecarlo" of calibration.json.
#pragma once
#include <string>
#include "io/json_file.h"
#include "io/result.h"
#include "solver/calibration.h"

namespace scancal {

Json ToJson(const MonteCarloSummary& summary);  // {} if there was none
// A number that is not finite comes back as not a number. file: for messages.
Result<MonteCarloSummary> MonteCarloFromJson(const Json& json, const std::string& file);

}  // namespace scancal
