#include "io/units.h"

namespace scancal {

std::optional<double> UnitSize(std::string_view unit, Dimension dimension) {
  if (dimension == Dimension::kLength) {
    if (unit == "mm") return 1.0;
    if (unit == "m") return 1000.0;
    if (unit == "um") return 0.001;
  }
  if (dimension == Dimension::kAngle) {
    if (unit == "deg") return 0.017453292519943295;
    if (unit == "rad") return 1.0;
  }
  return std::nullopt;
}

}  // namespace scancal
