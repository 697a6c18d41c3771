// Points that do not belong to the line of their profile.
#pragma once
#include <span>
#include <vector>

namespace scancal {

struct RobustLine {
  double y0 = 0, z0 = 0;  // a point of it, mm
  double dy = 0, dz = 1;  // unit direction
  double scale = 0;       // standard deviation of the distances to it, from their median; 0 with fewer than five points
  double Distance(double y, double z) const { return dz * (y - y0) - dy * (z - z0); }
};

// Least median of squares (Rousseeuw 1984) over well separated pairs of an ordered subsample, then least squares on
// what lies within six scales. Up to 40 % of the points may lie anywhere. Deterministic; does not depend on the order
// of the points.
RobustLine FitRobustLine(std::span<const double> y, std::span<const double> z);

// Least step between values of a quantised measurement; 0 if the values hardly repeat.
double Resolution(std::span<const double> values);

}  // namespace scancal
