#include "solver/uncertainty/gum.h"
#include <gtest/gtest.h>
#include <limits>

namespace scancal {
namespace {

TEST(PropagateCovariance, CountsWhatStandsOffTheDiagonal) {
  Eigen::Matrix2d v;
  v << 4, -3, -3, 9;
  Eigen::MatrixXd s(3, 2);
  s << 1, 1, 1, -1, 2, 0;
  Eigen::Matrix3d expected;  // by hand: var(a + b) = 4 + 9 - 6, var(a - b) = 4 + 9 + 6, ...
  expected << 7, -5, 2, -5, 19, 14, 2, 14, 16;
  EXPECT_EQ(PropagateCovariance(s, v), expected);
}

TEST(Correlations, AreCovariancesByBothUncertainties) {
  Eigen::Matrix2d v, expected;
  v << 4, -3, -3, 9;
  expected << 1, -0.5, -0.5, 1;
  EXPECT_LT((Correlations(v) - expected).norm(), 1e-15);
}

TEST(EffectiveDof, IsTheFormulaOfWelchAndSatterthwaite) {
  const double two[] = {3, 4}, dofs[] = {5, 8};
  EXPECT_NEAR(EffectiveDof(two, dofs), 625 / (81.0 / 5 + 256.0 / 8), 1e-12);
  const double equal[] = {2, 2, 2}, same[] = {7, 7, 7};
  EXPECT_NEAR(EffectiveDof(equal, same), 21, 1e-12);
}

TEST(EffectiveDof, WhatIsExactlyKnownAddsVarianceAlone) {
  const double two[] = {3, 4}, one_known[] = {5, kInfinity}, both_known[] = {kInfinity, kInfinity};
  EXPECT_NEAR(EffectiveDof(two, one_known), 625 * 5 / 81.0, 1e-12);
  EXPECT_EQ(EffectiveDof(two, both_known), kInfinity);
}

}  // namespace
}  // namespace scancal
