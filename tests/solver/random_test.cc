#include "solver/random.h"
#include <Random123/philox.h>
#include <gtest/gtest.h>
#include <cmath>

namespace scancal {
namespace {

TEST(Random, IsPhiloxOfSeedAndStream) {
  const r123::Philox2x64::ctr_type out = r123::Philox2x64()({{0, 7}}, {{42}});
  Random random(42, 7);
  EXPECT_EQ(random.Uniform(), (static_cast<double>(out[1] >> 11) + 0.5) * 0x1p-53);
  // The published known answer of Philox4x32-10 for zero counter and key.
  EXPECT_EQ(r123::Philox4x32()({{0, 0, 0, 0}}, {{0, 0}})[0], 0x6627e8d5u);
}

TEST(Random, RepeatsAndSeparatesStreams) {
  Random a(1, 1), b(1, 1), c(1, 2), d(2, 1);
  const double first = a.Normal();
  EXPECT_EQ(first, b.Normal());
  EXPECT_NE(first, c.Normal());
  EXPECT_NE(first, d.Normal());
}

TEST(Random, HasTheMomentsOfANormal) {
  Random random(3, 0);
  const int n = 200000;
  double sum = 0, squares = 0, fourth = 0;
  for (int i = 0; i < n; ++i) {
    const double x = random.Normal();
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
  }
  EXPECT_NEAR(sum / n, 0, 4 / std::sqrt(n));
  EXPECT_NEAR(squares / n, 1, 4 * std::sqrt(2.0 / n));
  EXPECT_NEAR(fourth / n, 3, 4 * std::sqrt(96.0 / n));
}

}  // namespace
}  // namespace scancal
