// Results as text: for the terminal, and points with their uncertainty for programs.
#pragma once
#include <string>
#include "solver/calibration.h"
#include "solver/results.h"

namespace scancal {

std::string ToText(const Calibration& calibration);
std::string ToText(const Comparison& comparison);
std::string ToText(const Propagation& propagation);
std::string ToText(const Selftest& selftest);

// One line a point, with its distance from the one before where there are distances. mm and deg; a table of points that
// can be read again.
std::string ToCsv(const Propagation& propagation);

}  // namespace scancal
