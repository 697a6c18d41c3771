// What the residuals of points along lines say of the noise: its correlation, its shape, and what it does to a line.
#pragma once
#include <array>
#include <span>
#include <vector>

namespace scancal {

// Pooled over lines, at lags of 0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, ... points: all vectors have an entry per lag.
struct LagSums {
  std::vector<double> products;  // sum e_i e_{i + lag} of the residuals from each line's own fit
  std::vector<double> pairs;     // how many
  std::vector<double> absorbed;  // sum H_{i, i + lag}, H the projection on (1, z) that made the residuals

  // The residuals of one line in the order along it; up to half its length. H is taken as of evenly spaced points.
  void Add(std::span<const double> residuals);
  static double Lag(size_t index);
};

struct LineCorrelation {
  std::vector<double> lags, correlation;  // correlation[0] = 1; empty without a pair
  double length = 0;                      // integrated: 1 + 2 sum of the correlation over all lags >= 1; 0: not known
  bool dies_out = true;                   // false: no end was seen along these lines, and length is a lower bound
};

// The fitted lines take away part of what they are to show. With autocovariance c(k) and C = sum of c over all lags,
// noise that is correlated over much less than a line has E[e e'] = V - C H, hence
//
//     E[products(k)] = pairs(k) c(k) - C absorbed(k),   C = 2 integral of c from 0 to the cut,
//
// which is linear in C and solved for it. The cut is the first lag whose correlation is below twice its standard error
// (Bartlett 1946); integrals are by the trapezoidal rule over the lags, at most 5 % too large for an exponential decay.
// From hundreds of lines of n points a true length of n / 15 and less comes out right to 3 %; at n / 5 it is a quarter
// too small, at 2 n / 3 it is 0.3 of the truth, and neither dies out. From three lines the cut comes early: 5 % too
// small at n / 50, 15 % at n / 15, 40 % at n / 5.
LineCorrelation Correlate(const LagSums& sums);

// Counts of residual / scale: 81 bins of equal width from -8 to 8, the middle one about zero.
struct ResidualHistogram {
  static constexpr int kBins = 81;
  static constexpr double kLimit = 8;
  double scale = 0;                    // a standard deviation of the residuals; 0: nothing is counted
  std::array<double, kBins> counts{};  // bin 0 begins at -kLimit
  double below = 0, above = 0;         // beyond the limits
  void Add(std::span<const double> residuals);
};

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
