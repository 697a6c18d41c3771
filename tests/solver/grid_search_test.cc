#include "solver/grid_search.h"
#include <gtest/gtest.h>
#include <cmath>

namespace scancal {
namespace {

const GridBox kPublished{{110, 395}, {130, 425}, 1};

void Bowl(const std::array<double, 2>& at, std::span<double> values) {
  for (size_t t = 0; t < values.size(); ++t)
    values[t] = std::pow(at[0] - 123 - static_cast<double>(t), 2) + std::pow(at[1] - 409, 2);
}

TEST(GridSearch, HasThePublishedNumberOfNodes) {
  GridBox box = kPublished;
  EXPECT_EQ(GridSearch(box, 1, Bowl).nodes, 651);
  box.step = 0.1;
  EXPECT_EQ(GridSearch(box, 1, Bowl).nodes, 60501);
}

TEST(GridSearch, FindsTheMinimumOfTheMean) {
  const GridResult result = GridSearch(kPublished, 3, Bowl);
  EXPECT_EQ(result.best.at[0], 124);
  EXPECT_EQ(result.best.at[1], 409);
  EXPECT_NEAR(result.best.value, 2.0 / 3, 1e-15);
  EXPECT_FALSE(result.best.on_edge);
}

TEST(GridSearch, LeavesEachTargetOutInTheSamePass) {
  const auto three_only = [](const std::array<double, 2>& at, std::span<double> values) {
    values[0] = std::abs(at[0] - 115) + std::abs(at[1] - 400);
    values[1] = std::abs(at[0] - 120) + std::abs(at[1] - 410);
  };
  const GridResult result = GridSearch(kPublished, 2, three_only);
  ASSERT_EQ(result.without.size(), 2u);
  EXPECT_EQ(result.without[0].at[0], 120);
  EXPECT_EQ(result.without[1].at[1], 400);
}

TEST(GridSearch, TakesTheFirstOfEqualMinimaForAnyNumberOfThreads) {
  const auto two_valleys = [](const std::array<double, 2>& at, std::span<double> values) {
    values[0] = std::min(std::abs(at[0] - 112), std::abs(at[0] - 128));
  };
  for (const int threads : {1, 2, 5}) {
    const GridResult result = GridSearch(kPublished, 1, two_valleys, threads);
    EXPECT_EQ(result.best.at[0], 112) << threads;
    EXPECT_EQ(result.best.at[1], 395) << threads;
  }
}

TEST(GridSearch, TellsThatTheMinimumLiesOnTheEdge) {
  GridBox box = kPublished;
  box.upper[0] = 122;
  EXPECT_TRUE(GridSearch(box, 1, Bowl).best.on_edge);
  box = kPublished;
  box.lower[1] = 410;
  EXPECT_TRUE(GridSearch(box, 1, Bowl).best.on_edge);
  box = kPublished;
  box.lower[0] = box.upper[0] = 123;  // held: no edge to lie on
  EXPECT_FALSE(GridSearch(box, 1, Bowl).best.on_edge);
}

}  // namespace
}  // namespace scancal
