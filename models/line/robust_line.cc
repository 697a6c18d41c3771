#include "models/line/robust_line.h"
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include "models/median.h"

namespace scancal {
namespace {

constexpr size_t kSubsample = 48;
constexpr size_t kFewestPoints = 5;
constexpr double kWithin = 6;  // scales

struct Ordered {
  std::vector<double> y, z;
};

// Every so-many-th point in the order of z: the same points for any order of the input.
Ordered OrderedSubsample(std::span<const double> y, std::span<const double> z) {
  std::vector<size_t> order(y.size());
  std::iota(order.begin(), order.end(), 0);
  const auto before = [&](size_t a, size_t b) { return z[a] != z[b] ? z[a] < z[b] : y[a] < y[b]; };
  if (!std::is_sorted(order.begin(), order.end(), before)) std::sort(order.begin(), order.end(), before);
  const size_t n = std::min(order.size(), kSubsample);
  Ordered sample;
  for (size_t k = 0; k < n; ++k) {
    const size_t i = order[k * order.size() / n + order.size() / n / 2];
    sample.y.push_back(y[i]);
    sample.z.push_back(z[i]);
  }
  return sample;
}

double MedianDistance(const RobustLine& line, std::span<const double> y, std::span<const double> z,
                      std::vector<double>* buffer) {
  buffer->resize(y.size());
  for (size_t i = 0; i < y.size(); ++i) (*buffer)[i] = std::abs(line.Distance(y[i], z[i]));
  const auto middle = buffer->begin() + std::ssize(*buffer) / 2;
  std::nth_element(buffer->begin(), middle, buffer->end());
  return *middle;
}

// Whether MedianDistance would be below `least`: counting is much faster than finding it.
bool IsNearer(const RobustLine& line, std::span<const double> y, std::span<const double> z, double least) {
  size_t near = 0;
  for (size_t i = 0; i < y.size(); ++i) near += std::abs(line.Distance(y[i], z[i])) < least;
  return near > y.size() / 2;
}

RobustLine Through(const Ordered& points, size_t i, size_t j) {
  const double dy = points.y[j] - points.y[i], dz = points.z[j] - points.z[i], length = std::hypot(dy, dz);
  if (!(length > 0)) return {points.y[i], points.z[i], 0, 1, 0};
  return {points.y[i], points.z[i], dy / length, dz / length, 0};
}

// Total least squares of the points within a distance of the line.
RobustLine Refit(const RobustLine& line, double within, std::span<const double> y, std::span<const double> z) {
  double n = 0, sy = 0, sz = 0, syy = 0, szz = 0, syz = 0;
  for (size_t i = 0; i < y.size(); ++i) {
    if (std::abs(line.Distance(y[i], z[i])) > within) continue;
    const double v = y[i] - line.y0, w = z[i] - line.z0;
    ++n;
    sy += v, sz += w, syy += v * v, szz += w * w, syz += v * w;
  }
  if (n < 2) return line;
  const double my = sy / n, mz = sz / n;
  const double angle = 0.5 * std::atan2(2 * (syz - n * my * mz), (szz - n * mz * mz) - (syy - n * my * my));
  return {line.y0 + my, line.z0 + mz, std::sin(angle), std::cos(angle), 0};
}

// Whether at most half of the values differ from all before them; stops as soon as more do.
bool Repeats(std::span<const double> values) {
  std::vector<double> seen(std::bit_ceil(2 * values.size() + 1), std::numeric_limits<double>::quiet_NaN());
  size_t different = 0;
  for (const double value : values) {
    constexpr uint64_t kGolden = 0x9e3779b97f4a7c15;  // Knuth, The Art of Computer Programming, 6.4
    const double plain = value + 0.0;                 // one zero
    size_t at = (std::bit_cast<uint64_t>(plain) * kGolden >> 20) & (seen.size() - 1);
    while (!std::isnan(seen[at]) && seen[at] != plain) at = (at + 1) & (seen.size() - 1);
    if (seen[at] == plain) continue;
    seen[at] = plain;
    if (2 * ++different > values.size()) return false;
  }
  return true;
}

}  // namespace

RobustLine FitRobustLine(std::span<const double> y, std::span<const double> z) {
  const size_t n = y.size();
  if (n < kFewestPoints)
    return Refit({n ? y[0] : 0, n ? z[0] : 0, 0, 1, 0}, std::numeric_limits<double>::infinity(), y, z);
  const Ordered sample = OrderedSubsample(y, z);
  const size_t size = sample.y.size();
  std::vector<double> buffer;
  RobustLine best;
  double least = std::numeric_limits<double>::infinity();
  for (const size_t apart : {size / 2, size / 3}) {
    for (size_t i = 0; i + apart < size; ++i) {
      const RobustLine line = Through(sample, i, i + apart);
      if (!IsNearer(line, sample.y, sample.z, least)) continue;
      least = MedianDistance(line, sample.y, sample.z, &buffer);
      best = line;
    }
  }
  // The small-sample factor of Rousseeuw and Leroy (1987), 5.2.
  const double factor = kMadToSigma * (1 + 5.0 / static_cast<double>(n - 2));
  for (int round = 0; round < 3; ++round) {
    best.scale = factor * MedianDistance(best, y, z, &buffer);
    const double scale = best.scale;
    best = Refit(best, kWithin * scale, y, z);
  }
  best.scale = factor * MedianDistance(best, y, z, &buffer);
  return best;
}

double Resolution(std::span<const double> values) {
  if (!Repeats(values)) return 0;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  double least = std::numeric_limits<double>::infinity();
  size_t repeats = 0;
  for (size_t i = 1; i < sorted.size(); ++i) {
    const double gap = sorted[i] - sorted[i - 1];
    if (gap > 0) least = std::min(least, gap);
    repeats += gap == 0;
  }
  return 2 * repeats >= sorted.size() && std::isfinite(least) ? least : 0;
}

}  // namespace scancal
