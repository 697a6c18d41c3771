// Noise along a line that is not white.
#pragma once

namespace scancal {

// Of the straight line through the points, for noise of standard deviation one.
struct LineNoise {
  double offset = 0;  // at the middle
  double slope = 0;   // 1/mm
};

// What first-order autoregressive noise of integrated correlation length `length` (points; 1 is white) adds to the
// standard deviations of offset and slope of the least squares line through `points` equally spaced ones, beyond white
// noise: in quadrature. spread: rms distance of the points from their middle, mm.
LineNoise ExcessOfCorrelatedNoise(double length, double points, double spread);

}  // namespace scancal
