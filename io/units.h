// Units that a data set may declare, and their size in the units used inside: mm and rad.
#pragma once
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

namespace scancal {

inline constexpr double kTurn_rad = 2 * std::numbers::pi, kDegree = std::numbers::pi / 180;  // rad

enum class Dimension { kNone, kLength, kAngle };

struct Units {
  std::string length = "mm", angle = "deg";  // as declared
  double length_in_mm = 1;                   // one declared unit of length, mm
  double angle_in_rad = kDegree;             // one declared unit of angle, rad
  double Of(Dimension dimension) const {
    return dimension == Dimension::kLength ? length_in_mm : dimension == Dimension::kAngle ? angle_in_rad : 1.0;
  }
};

// mm | m | um in mm, deg | rad in rad; empty if it is no unit of that dimension.
inline std::optional<double> UnitSize(std::string_view unit, Dimension dimension) {
  if (dimension == Dimension::kLength) {
    if (unit == "mm") return 1.0;
    if (unit == "m") return 1000.0;
    if (unit == "um") return 0.001;
  }
  if (dimension == Dimension::kAngle) {
    if (unit == "deg") return kDegree;
    if (unit == "rad") return 1.0;
  }
  return std::nullopt;
}

// The same of a unit as headers of tables write it: also cm, nm, micron, degrees, mrad and the signs, in any case.
inline std::optional<double> HeaderUnit(std::string_view unit, Dimension dimension) {
  std::string lower(unit);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c;
  if (const auto known = UnitSize(lower, dimension)) return known;
  if (dimension == Dimension::kLength) {
    if (lower == "\u00B5m" || lower == "\u03BCm" || lower == "micron") return 0.001;
    if (lower == "cm") return 10.0;
    if (lower == "nm") return 1e-6;
  }
  if (dimension == Dimension::kAngle) {
    if (lower == "\u00B0" || lower == "degree" || lower == "degrees") return kDegree;
    if (lower == "mrad") return 0.001;
  }
  return std::nullopt;
}

}  // namespace scancal
