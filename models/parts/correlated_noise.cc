#include "models/parts/correlated_noise.h"
#include <algorithm>
#include <cmath>
#include <vector>

namespace scancal {
namespace {

// a' R a - a' a, R_ij = phi^|i - j|.
double Excess(const std::vector<double>& a, double phi) {
  double sum = 0, before = 0;  // before: sum of phi^(i - j) a_j over j < i
  for (const double x : a) {
    sum += 2 * x * before;
    before = phi * (before + x);
  }
  return std::max(0.0, sum);
}

}  // namespace

LineNoise ExcessOfCorrelatedNoise(double length, double points, double spread) {
  const auto n = static_cast<size_t>(points);
  if (!(length > 1) || n < 2 || !(spread > 0)) return {};
  const double phi = (length - 1) / (length + 1);
  const double step = spread * std::sqrt(12 / (points * points - 1));  // of equally spaced points
  std::vector<double> mean(n, 1 / points), slope(n);
  for (size_t i = 0; i < n; ++i)
    slope[i] = (static_cast<double>(i) - (points - 1) / 2) * step / (points * spread * spread);
  return {std::sqrt(Excess(mean, phi)), std::sqrt(Excess(slope, phi))};
}

}  // namespace scancal
