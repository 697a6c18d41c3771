#include "models/line/moments.h"
#include <cmath>

// No Eigen here: this file alone is compiled for several processors. None of
// them may contract a * b + c, or those that can would have other digits.
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off")
#endif
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define SCANCAL_FOR_EACH_PROCESSOR __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define SCANCAL_FOR_EACH_PROCESSOR
#endif
#if defined(__GNUC__)
#define SCANCAL_INLINE __attribute__((always_inline))
#else
#define SCANCAL_INLINE
#endif
// GCC 12 must find the loop over the lanes as a loop: it makes one vector of
// it, but scalars if it has unrolled it before (a fifth of the speed).
#if defined(__GNUC__) && !defined(__clang__)
#define SCANCAL_AS_VECTOR _Pragma("GCC unroll 1")
#else
#define SCANCAL_AS_VECTOR
#endif

namespace scancal {
namespace {

constexpr size_t kLanes = 8;

struct Lanes {
  alignas(kLanes * sizeof(double)) double sum[kLanes] = {};
  double Total() const { return ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7])); }
};

// visit(i, lane) for all i < n.
template <class Visit>
SCANCAL_INLINE inline void ForEach(size_t n, const Visit& visit) {
  const size_t whole = n - n % kLanes;
  for (size_t i = 0; i < whole; i += kLanes) {
    SCANCAL_AS_VECTOR
    for (size_t k = 0; k < kLanes; ++k) visit(i + k, k);
  }
  for (size_t k = 0; k < n - whole; ++k) visit(whole + k, k);
}

}  // namespace

SCANCAL_FOR_EACH_PROCESSOR LineFactor FactorLine(const double* y, const double* z, size_t n) {
  if (n == 0) return {};
  const double count = static_cast<double>(n), root = std::sqrt(count);

  Lanes sum_y, sum_z;
  ForEach(n, [&](size_t i, size_t k) SCANCAL_INLINE {
    sum_y.sum[k] += y[i];
    sum_z.sum[k] += z[i];
  });
  double mean_y = sum_y.Total() / count, mean_z = sum_z.Total() / count;

  // About the means, whose own rounding shows in the sums of the differences.
  Lanes left_y, left_z, zz, zy;
  ForEach(n, [&](size_t i, size_t k) SCANCAL_INLINE {
    const double dy = y[i] - mean_y, dz = z[i] - mean_z;
    left_y.sum[k] += dy;
    left_z.sum[k] += dz;
    zz.sum[k] += dz * dz;
    zy.sum[k] += dz * dy;
  });
  const double shift_y = left_y.Total() / count, shift_z = left_z.Total() / count;
  const double r11 = std::sqrt(std::fmax(0.0, zz.Total() - count * shift_z * shift_z));
  const double slope = r11 > 0 ? (zy.Total() - count * shift_z * shift_y) / (r11 * r11) : 0;
  mean_y += shift_y;
  mean_z += shift_z;

  // The residual of y, and what rounding left in it of 1 and z.
  Lanes left, left_by_z, squares;
  ForEach(n, [&](size_t i, size_t k) SCANCAL_INLINE {
    const double dz = z[i] - mean_z, e = (y[i] - mean_y) - slope * dz;
    left.sum[k] += e;
    left_by_z.sum[k] += e * dz;
    squares.sum[k] += e * e;
  });
  const double of_one = left.Total() / root, of_z = r11 > 0 ? left_by_z.Total() / r11 : 0;
  const double r22 = std::sqrt(std::fmax(0.0, squares.Total() - of_one * of_one - of_z * of_z));
  return {root, root * mean_z, root * mean_y + of_one, r11, slope * r11 + of_z, r22};
}

SCANCAL_FOR_EACH_PROCESSOR double SumOfProducts(const double* a, const double* b, size_t n) {
  Lanes products;
  ForEach(n, [&](size_t i, size_t k) SCANCAL_INLINE { products.sum[k] += a[i] * b[i]; });
  return products.Total();
}

SCANCAL_FOR_EACH_PROCESSOR bool IsAscending(const double* values, size_t n) {
  Lanes ascents;
  if (n > 1) ForEach(n - 1, [&](size_t i, size_t k) SCANCAL_INLINE { ascents.sum[k] += values[i] <= values[i + 1]; });
  return n < 2 || ascents.Total() == static_cast<double>(n - 1);
}

}  // namespace scancal
