#include "models/parts/residual_histogram.h"
#include <cmath>

namespace scancal {

void ResidualHistogram::Add(std::span<const double> residuals) {
  if (!(scale > 0)) return;
  const double bins_per_unit = kBins / (2 * kLimit) / scale;
  for (const double residual : residuals) {
    const double bin = std::floor((residual + kLimit * scale) * bins_per_unit);
    if (bin < 0) {
      ++below;
    } else if (bin >= kBins) {
      ++above;
    } else {
      ++counts[static_cast<size_t>(bin)];
    }
  }
}

}  // namespace scancal
