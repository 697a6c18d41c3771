// The table of scripts/coverage with fewer and smaller data sets.
#include <gtest/gtest.h>
#include <boost/math/distributions/binomial.hpp>
#include "tests/coverage/tally.h"

namespace scancal::coverage {
namespace {

constexpr size_t kSets = 120;

class Coverage : public ::testing::TestWithParam<const char*> {};

TEST_P(Coverage, StatedIntervalsHoldTheTruth) {
  const std::vector<Row> rows = Rows();
  const auto row = std::find_if(rows.begin(), rows.end(), [](const Row& each) { return each.name == GetParam(); });
  ASSERT_NE(row, rows.end());
  Row small = *row;
  small.scene.profiles = 40;
  small.scene.points = 30;
  const Tally tally = Count(TryAll(small, 1000, kSets, 2));
  Table table;
  table.Add(small, tally);
  std::cerr << table.Markdown();
}

INSTANTIATE_TEST_SUITE_P(, Coverage, ::testing::Values("white", "jitter 20 arcsec", "line correlation 40 points"));

}  // namespace
}  // namespace scancal::coverage
