// Results as text for the terminal.
#pragma once
#include <string>
#include "solver/calibration.h"
#include "solver/results.h"

namespace scancal {

std::string ToText(const Calibration& calibration);
std::string ToText(const Comparison& comparison);
std::string ToText(const Selftest& selftest);

}  // namespace scancal
