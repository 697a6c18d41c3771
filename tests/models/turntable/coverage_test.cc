// The table of scripts/coverage with fewer and smaller data sets.
#include <gtest/gtest.h>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include "tests/coverage/tally.h"

namespace scancal::coverage {
namespace {

constexpr size_t kSets = 80;

class Coverage : public ::testing::TestWithParam<const char*> {};

TEST_P(Coverage, StatedIntervalsHoldTheTruth) {
  const std::vector<Row> rows = Rows();
  const auto row = std::find_if(rows.begin(), rows.end(), [](const Row& each) { return each.name == GetParam(); });
  ASSERT_NE(row, rows.end());
  Row small = *row;
  small.scene.profiles = 40;
  small.scene.points = 30;
  const Tally tally = Count(TryAll(small, 1000, kSets, 2));
  // Intervals of 95 % fall short of this count once in 10,000 right runs.
  const boost::math::binomial right(kSets, 0.95);
  const double least = boost::math::quantile(right, 1e-4) / kSets;
  for (const int k : {0, 1}) {
    EXPECT_GE(tally.stated[k], least);
    EXPECT_LE(tally.width[k], small.widest);
    EXPECT_NEAR(tally.oracle[k], 1, 4 / std::sqrt(2.0 * kSets));
    // Otherwise the row would show nothing: all noise but white is invisible to the naive figure.
    if (row->name != "white noise") {
      EXPECT_LE(tally.naive[k], least);
    }
  }
  EXPECT_LE(tally.unreliable, 1.0 / kSets);
}

// Rows whose oracle is that of independent profiles: only the stated interval is asked.
class CoverageOfMore : public ::testing::TestWithParam<const char*> {};

TEST_P(CoverageOfMore, StatedIntervalsHoldTheTruth) {
  const std::vector<Row> rows = Rows();
  const auto row = std::find_if(rows.begin(), rows.end(), [](const Row& each) { return each.name == GetParam(); });
  ASSERT_NE(row, rows.end());
  Row small = *row;
  small.scene.profiles = 60;
  small.scene.points = 30;
  const Tally tally = Count(TryAll(small, 2000, kSets, 2));
  const boost::math::binomial right(kSets, 0.95);
  const double least = boost::math::quantile(right, 1e-4) / kSets;
  for (const int k : {0, 1}) EXPECT_GE(tally.stated[k], least) << k;
  EXPECT_LE(tally.unreliable, 4.0 / kSets);
}

INSTANTIATE_TEST_SUITE_P(, CoverageOfMore,
                         ::testing::Values("drift 0.2 mm over sweeps there and back, drift: 0",
                                           "lens: linearity_3, lens_z2, lens_yz2 of 10 um, declared",
                                           "profiles err by 20 um, neighbours correlated 0.8",
                                           "angle in steps of 0.2 deg", "form 5 um, one plate, not declared"));

INSTANTIATE_TEST_SUITE_P(, Coverage,
                         ::testing::Values("white noise", "jitter 20 arcsec", "line correlation 40 points"));

}  // namespace
}  // namespace scancal::coverage
