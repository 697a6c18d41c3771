#include <fmt/format.h>
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include "tests/bench/comparisons.h"

// As models/parts/moments.cc: what the processor has.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define SCANCAL_FOR_EACH_PROCESSOR __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define SCANCAL_FOR_EACH_PROCESSOR
#endif

namespace scancal::bench {
namespace {

constexpr size_t kProfile = 1000;  // points

// 32 lanes: enough sums under way to wait for nothing but memory.
SCANCAL_FOR_EACH_PROCESSOR double Sum(const double* values, size_t count) {
  constexpr size_t kLanes = 32;
  double lanes[kLanes] = {};
  for (size_t i = 0; i + kLanes <= count; i += kLanes)
    for (size_t k = 0; k < kLanes; ++k) lanes[k] += values[i + k];
  double sum = 0;
  for (const double lane : lanes) sum += lane;
  return sum;
}

// More than the last-level cache holds, so that both sides fetch from memory; at least three million points.
size_t Points() {
  const long cache = std::max(0L, ::sysconf(_SC_LEVEL3_CACHE_SIZE));
  const size_t points = std::clamp<size_t>(2 * static_cast<size_t>(cache) / 16, 3'000'000, 60'000'000);
  return points - points % (32 * kProfile);
}

std::string Rate(double bytes, double seconds) { return fmt::format("{:.3g} GB/s", bytes / seconds / 1e9); }

}  // namespace

void CompareCompression(Table* table) {
  Say("compression of points in memory");
  const size_t points = Points();
  std::vector<double> y(points), z(points);
  for (size_t i = 0; i < points; ++i) {
    z[i] = 0.2 * static_cast<double>(i % kProfile) - 100;
    y[i] = 75 + 0.1 * z[i] + 1e-4 * static_cast<double>(i * 7919 % 1009);  // neither constant nor exactly a line
  }
  volatile double keep = 0;  // so that no work may be left out
  const double sum_s = MedianSecondsOf([&] { keep = Sum(y.data(), points) + Sum(z.data(), points); });
  const double ours_s = MedianSecondsOf([&] {
    double used = 0;
    for (size_t i = 0; i < points; i += kProfile)
      used += CompressProfile(0.1, {y.data() + i, kProfile}, {z.data() + i, kProfile}, {}).factor(2, 2);
    keep = used;
  });
  const double bytes = 16 * static_cast<double>(points), ratio = sum_s / ours_s;
  table->Add({"compressing points in memory, against one core's sum of the same bytes", Rate(bytes, ours_s),
              Rate(bytes, sum_s), Ratio(ratio), "at least 0.25", ratio >= 0.25 ? "yes" : "NO"});
  table->Note(
      fmt::format("Compression: {:.1f} million points (y, z) in profiles of {}, {:.0f} MB; the sum runs in 32 "
                  "lanes.",
                  static_cast<double>(points) / 1e6, kProfile, bytes / 1e6));
}

}  // namespace scancal::bench
