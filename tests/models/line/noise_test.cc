// Correlation along the line: what the estimate is worth, and where it is too small.
#include "models/line/noise.h"
#include <gtest/gtest.h>
#include <cmath>
#include "solver/random.h"
#include "tests/models/turntable/scene.h"

namespace scancal {
namespace {

// Of one placement with so many profiles of so many points; the noise is autoregressive of first order.
LagSums Simulated(int profiles, int points, double length, uint64_t seed = 1) {
  turntable::Scene scene;
  scene.placements = 1;
  scene.profiles = profiles;
  scene.points = points;
  scene.line_correlation = length;
  scene.seed = seed;
  const auto placements = turntable::Simulate(scene);
  LagSums sums;
  for (const turntable::SimulatedProfile& raw : placements[0].profiles) {
    const turntable::Profile profile = turntable::CompressProfile(raw.alpha, raw.y, raw.z, {});
    sums.Add(turntable::ResidualsFromLine(profile, raw.y, raw.z));
  }
  return sums;
}

struct Expectation {
  int points;
  double length, found, deviation;  // mean and standard deviation of 20 such estimates
  bool dies_out;
};

TEST(LineCorrelation, OfTwoHundredProfiles) {
  for (const Expectation& e : {Expectation{200, 1, 1, 0.005, true},  //
                               {200, 5, 5.02, 0.14, true},
                               {200, 40, 29.1, 0.87, false},   // the lines take away what is as long as they are
                               {200, 130, 38.0, 0.74, false},  //
                               {2000, 1, 1, 0.002, true},
                               {2000, 5, 5.05, 0.05, true},
                               {2000, 40, 40.7, 1.1, true}}) {
    const LineCorrelation found = Correlate(Simulated(200, e.points, e.length));
    EXPECT_NEAR(found.length, e.found, 4 * e.deviation) << e.points << " points, length " << e.length;
    EXPECT_EQ(found.dies_out, e.dies_out) << e.points << " points, length " << e.length;
  }
  const LineCorrelation longest = Correlate(Simulated(200, 2000, 130));
  EXPECT_NEAR(longest.length, 134.5, 4 * 10.8);
}

TEST(LineCorrelation, DecaysAsItWasMade) {
  const LineCorrelation found = Correlate(Simulated(200, 2000, 40));
  for (size_t k = 0; k < found.lags.size() && found.lags[k] <= 48; ++k)
    EXPECT_NEAR(found.correlation[k], std::pow(39.0 / 41, found.lags[k]), 0.03) << "lag " << found.lags[k];
}

TEST(LineCorrelation, WithoutTheCorrectionItWouldBeTooSmall) {
  const LagSums sums = Simulated(200, 200, 5);
  LagSums uncorrected = sums;
  uncorrected.absorbed.assign(uncorrected.absorbed.size(), 0);
  EXPECT_LT(Correlate(uncorrected).length, 4.5);
  EXPECT_GT(Correlate(sums).length, 4.5);
}

TEST(LineCorrelation, TheLineAbsorbsTwoDegreesOfFreedomOfWhiteNoise) {
  const LagSums sums = Simulated(1000, 5, 1);
  EXPECT_NEAR(sums.absorbed[0], 2000, 1e-9);
  const double n = 4 * 1000;  // pairs at lag 1
  EXPECT_NEAR(Correlate(sums).length, 1, 4 * 2 / std::sqrt(n));
}

TEST(LagSums, GrowWithTheLinesAndPool) {
  LagSums sums;
  const std::vector<double> residuals = {1, -2, 3, 0.5, -1, 2, -3, 1};
  sums.Add(std::span(residuals).first(3));
  EXPECT_EQ(sums.products.size(), 2U);  // lags 0 and 1
  sums.Add(residuals);
  ASSERT_EQ(sums.products.size(), 5U);  // up to 4
  EXPECT_EQ(sums.products[0], 14 + 29.25);
  EXPECT_EQ(sums.products[1], -8 + (-2 - 6 + 1.5 - 0.5 - 2 - 6 - 3));
  EXPECT_EQ(sums.pairs[1], 2 + 7);
  EXPECT_EQ(sums.products[4], -1 - 4 - 9 + 0.5);
  EXPECT_EQ(sums.pairs[4], 4);
}

TEST(LagSums, TheLags) {
  const double lags[] = {0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128};
  for (size_t k = 0; k < std::size(lags); ++k) EXPECT_EQ(LagSums::Lag(k), lags[k]);
}

TEST(LineCorrelation, OfAlmostNothingIsNotKnown) {
  LagSums sums;
  EXPECT_EQ(Correlate(sums).length, 0);
  const std::vector<double> none(10, 0.0), three = {1, -2, 1};
  sums.Add(none);
  EXPECT_EQ(Correlate(sums).length, 0);
  LagSums few;
  few.Add(three);
  EXPECT_EQ(Correlate(few).length, 0);
  EXPECT_TRUE(Correlate(few).correlation.empty());
}

TEST(ResidualHistogram, CountsEveryResidualOnce) {
  ResidualHistogram histogram;
  histogram.scale = 0.05;
  histogram.Add(std::vector<double>{0, 1e-9, -1e-9, 0.05, -0.3999, 0.3999, 0.41, 5, -0.41});
  EXPECT_EQ(histogram.counts[40], 3);  // about zero
  EXPECT_EQ(histogram.counts[45], 1);  // 1 / (16 / 81) = 5.06 bins farther
  EXPECT_EQ(histogram.counts[0], 1);
  EXPECT_EQ(histogram.counts[80], 1);
  EXPECT_EQ(histogram.above, 2);
  EXPECT_EQ(histogram.below, 1);
}

TEST(ResidualHistogram, OfWhiteNoiseIsNormal) {
  ResidualHistogram histogram;
  histogram.scale = 2;
  Random random(1, 0);
  std::vector<double> residuals;
  for (int i = 0; i < 100000; ++i) residuals.push_back(2 * random.Normal());
  histogram.Add(residuals);
  const double width = 2 * ResidualHistogram::kLimit / ResidualHistogram::kBins;
  for (const int bin : {30, 36, 40, 44, 50}) {
    const double x = (bin - 40) * width, expected = 100000 * width * std::exp(-x * x / 2) / std::sqrt(2 * M_PI);
    EXPECT_NEAR(histogram.counts[static_cast<size_t>(bin)], expected, 4 * std::sqrt(expected)) << bin;
  }
}

TEST(ResidualHistogram, WithoutAScaleCountsNothing) {
  ResidualHistogram histogram;
  histogram.Add(std::vector<double>{0, 1});
  EXPECT_EQ(histogram.counts[40] + histogram.above, 0);
}

}  // namespace
}  // namespace scancal
