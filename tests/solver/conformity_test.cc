#include "solver/uncertainty/conformity.h"
#include <gtest/gtest.h>
#include <cmath>
#include "solver/random.h"
#include "solver/uncertainty/gum.h"

namespace scancal {
namespace {

TEST(ConformityOf, DecidesByGuardBandsOnBothSides) {
  const auto decide = [](double value) { return ConformityOf(value, 0.01, kInfinity, -0.1, 0.1).decision; };
  EXPECT_NEAR(ConformityOf(0, 0.01, kInfinity, -0.1, 0.1).guard, 0.01645, 1e-5);  // 1.645 u
  EXPECT_EQ(decide(0.083), Decision::kAccept);
  EXPECT_EQ(decide(0.084), Decision::kUndecided);
  EXPECT_EQ(decide(-0.116), Decision::kUndecided);
  EXPECT_EQ(decide(-0.117), Decision::kReject);
  EXPECT_GT(ConformityOf(0, 0.01, 3, -0.1, 0.1).guard, 0.023);  // t = 2.35
  EXPECT_EQ(ConformityOf(0, 0.2, kInfinity, -0.1, 0.1).decision,
            Decision::kUndecided);  // no zone of acceptance is left
}

TEST(ConformityOf, ItsProbabilityIsThatOfDraws) {
  constexpr int kTrials = 20000;
  Random random(1, 0);
  int outside = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const double truth = 0.06 + 0.05 * random.Normal();
    outside += truth < -0.1 || truth > 0.1;
  }
  const double p = ConformityOf(0.06, 0.05, kInfinity, -0.1, 0.1).p_outside;
  EXPECT_NEAR(outside / double{kTrials}, p, 4 * std::sqrt(p * (1 - p) / kTrials));
  EXPECT_NEAR(ConformityOf(0.1, 0.01, kInfinity, -0.1, 0.1).p_outside, 0.5, 1e-9);
}

}  // namespace
}  // namespace scancal
