#include <fmt/format.h>
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include "tests/bench/comparisons.h"

// As models/line/moments.cc: what the processor has.
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

// More than the last-level cache holds, so that both sides fetch from memory.
size_t PointsBeyondCache() {
  const long cache = std::max(0L, ::sysconf(_SC_LEVEL3_CACHE_SIZE));
  return std::clamp<size_t>(2 * static_cast<size_t>(cache) / 16, 6'000'000, 60'000'000);
}

std::string Rate(double bytes, double seconds) { return fmt::format("{:.3g} GB/s", bytes / seconds / 1e9); }

void Compare(size_t points, Table* table) {
  points -= points % (32 * kProfile);
  std::vector<double> y(points), z(points);
  for (size_t i = 0; i < points; ++i) {
    z[i] = 0.2 * static_cast<double>(i % kProfile) - 100;
    y[i] = 75 + 0.1 * z[i] + 1e-4 * static_cast<double>(i * 7919 % 1009);  // neither constant nor exactly a line
  }
  volatile double keep = 0;  // so that no work may be left out
  const auto compress = [&] {
    double used = 0;
    for (size_t i = 0; i < points; i += kProfile)
      used += turntable::CompressProfile(0.1, {y.data() + i, kProfile}, {z.data() + i, kProfile}, {}).factor(2, 2);
    keep = used;
  };
  const auto sum = [&] { keep = Sum(y.data(), points) + Sum(z.data(), points); };
  const std::vector<double> seconds = MedianSecondsOf({compress, sum});
  const double ours_s = seconds[0], sum_s = seconds[1];
  const double bytes = 16 * static_cast<double>(points), ratio = sum_s / ours_s;
  table->Add({fmt::format("compressing {:.0f} MB of points in memory; other: one core sums them", bytes / 1e6),
              Rate(bytes, ours_s), Rate(bytes, sum_s), Ratio(ratio), "at least 0.25", ratio >= 0.25 ? "yes" : "NO"});
}

}  // namespace

void CompareCompression(Table* table) {
  Say("compression of points in memory");
  Compare(3'000'000, table);
  Compare(PointsBeyondCache(), table);
  table->Note(
      fmt::format("Compression: points (y, z) in profiles of {}, three million and more than the cache of last "
                  "level holds; the sum runs in 32 lanes.",
                  kProfile));
}

}  // namespace scancal::bench
