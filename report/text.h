// Results as text for the terminal.
#pragma once
#include <string>
#include "solver/calibration.h"
#include "solver/comparison.h"
#include "solver/selftest.h"

namespace scancal {

std::string ToText(const Calibration& calibration);
std::string ToText(const Comparison& comparison);
std::string ToText(const Selftest& selftest);

}  // namespace scancal
