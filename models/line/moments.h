// The innermost loops of reading: one profile's points to six numbers, and products of its residuals.
#pragma once
#include <cstddef>

namespace scancal {

// R (upper triangular) of the n x 3 matrix with rows (1, z, y) = Q R, the diagonal not negative: r01 = sum z / sqrt(n),
// ...
struct LineFactor {
  double r00, r01, r02, r11, r12, r22;
};

// By modified Gram-Schmidt with one correction, as exact as Householder's QR: sums of squares are taken of residuals,
// never of raw coordinates. Eight lanes summed in a fixed order: the same digits on every processor. n = 0 gives zeros.
LineFactor FactorLine(const double* y, const double* z, size_t n);

// sum a_i b_i, in the same lanes.
double SumOfProducts(const double* a, const double* b, size_t n);

bool IsAscending(const double* values, size_t n);  // nowhere descending, and no nan

}  // namespace scancal
