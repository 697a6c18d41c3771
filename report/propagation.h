// Measured points and distances with their uncertainty, for people and for programs.
#pragma once
#include <string>
#include "solver/results.h"

namespace scancal {

std::string ToText(const Propagation& propagation);
// One line a point, with its distance from the one before where there are distances. mm and deg; a table of points that
// can be read again.
std::string ToCsv(const Propagation& propagation);

}  // namespace scancal
