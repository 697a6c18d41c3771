#include "models/turntable/form_modes.h"
#include <algorithm>
#include <cmath>

namespace scancal {
namespace {

constexpr int kLowest = 2, kHighest = 4;

using Legendre = std::array<double, kHighest + 1>;

// Orthonormal on [-1, 1] under its uniform distribution.
Legendre LegendreAt(double x) {
  Legendre p;
  for (int degree = 0; degree <= kHighest; ++degree)
    p[degree] = std::sqrt(2.0 * degree + 1) * std::legendre(static_cast<unsigned>(degree), x);
  return p;
}

}  // namespace

FormModes FormModesAt(double u, double v, double aspect) {
  const Legendre in_u = LegendreAt(std::clamp(u, -1.0, 1.0)), in_v = LegendreAt(std::clamp(v, -1.0, 1.0));
  FormModes modes;
  size_t k = 0;
  double squares = 0;
  for (int degree = kLowest; degree <= kHighest; ++degree) {
    for (int i = 0; i <= degree; ++i) {
      const double waves = i + aspect * (degree - i), share = 1 / (waves * waves);
      modes[k++] = share * in_u[i] * in_v[degree - i];
      squares += share * share;
    }
  }
  for (double& mode : modes) mode /= std::sqrt(squares);
  return modes;
}

}  // namespace scancal
