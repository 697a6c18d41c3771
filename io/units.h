// Units that a data set may declare, and their size in the units used inside: mm and rad.
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace scancal {

enum class Dimension { kNone, kLength, kAngle };

struct Units {
  std::string length = "mm", angle = "deg";    // as declared
  double length_in_mm = 1;                     // one declared unit of length, mm
  double angle_in_rad = 0.017453292519943295;  // one declared unit of angle, rad
  double Of(Dimension dimension) const {
    return dimension == Dimension::kLength ? length_in_mm : dimension == Dimension::kAngle ? angle_in_rad : 1.0;
  }
};

// mm | m | um in mm, deg | rad in rad; empty if it is no unit of that dimension.
std::optional<double> UnitSize(std::string_view unit, Dimension dimension);

}  // namespace scancal
