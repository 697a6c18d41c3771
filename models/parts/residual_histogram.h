// The shape of the noise: what a standard deviation does not tell.
#pragma once
#include <array>
#include <span>

namespace scancal {

// Counts of residual / scale: 81 bins of equal width from -8 to 8, the middle one about zero.
struct ResidualHistogram {
  static constexpr int kBins = 81;
  static constexpr double kLimit = 8;
  double scale = 0;                    // a standard deviation of the residuals; 0: nothing is counted
  std::array<double, kBins> counts{};  // bin 0 begins at -kLimit
  double below = 0, above = 0;         // beyond the limits
  void Add(std::span<const double> residuals);
};

}  // namespace scancal
