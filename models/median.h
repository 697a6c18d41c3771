// What robust scales are made of.
#pragma once
#include <algorithm>
#include <vector>

namespace scancal {

// Median absolute deviation to standard deviation, of a normal distribution.
inline constexpr double kMadToSigma = 1.4826;

// The upper one of an even number; 0 of none.
inline double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace scancal
