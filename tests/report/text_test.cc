#include "report/text.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include "tests/report/some_calibration.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST(TextTest, TheMonteCarloStandsBesideValueAndU) {
  Calibration c = SomeCalibration();
  EXPECT_THAT(ToText(c), Not(HasSubstr("Monte Carlo")));
  c.monte_carlo = SomeMonteCarlo();
  EXPECT_THAT(ToText(c),
              AllOf(HasSubstr("Monte Carlo: 10000 trials, seed 18446744073709551615; value +- U validated to "
                              "one digit of u (JCGM 101, clause 8)\n"),
                    ContainsRegex("M +123.002 +mm +0.011 +122.980 +123.024 +122.980 +123.024 +0.0050 +PASS"),
                    ContainsRegex("N .*infinite .*FAIL"), Not(HasSubstr("too few"))));
  c.monte_carlo.digits = 2;
  c.monte_carlo.stable = false;
  EXPECT_THAT(ToText(c), AllOf(HasSubstr("two digits"), HasSubstr("too few")));
}

TEST(TextTest, TheReportNamesEverythingThatMatters) {
  Calibration c = SomeCalibration();
  c.warnings = {Sentence{"a first warning"}, Sentence{"a second"}};
  const std::string text = ToText(c);
  EXPECT_THAT(text, AllOf(HasSubstr("123.002(11)"), HasSubstr("409.100(20)"), HasSubstr("considered"),
                          HasSubstr("set aside: left: 2 points off the line"),
                          HasSubstr("set aside: left: 5 points off the plane"), HasSubstr("warning: a first warning\n"),
                          HasSubstr("warning: a second\n")));
  EXPECT_THAT(text, AllOf(HasSubstr("not a traceable uncertainty"), HasSubstr("\nstatus: ok\n")));
  EXPECT_THAT(text, Not(HasSubstr("tilt_y")));  // held at 0: nothing to tell
  EXPECT_THAT(text, Not(HasSubstr("nan")));
}

TEST(TextTest, OfManyQuantitiesASummary) {
  Calibration c = WithBudgetAndVolume();
  const Parameter M = *c.Find("M"), N = *c.Find("N");
  c.jackknife = {{M.value, N.value + N.u}};
  for (const char* name : {"a", "b", "c"}) {
    c.parameters.push_back(M);
    c.parameters.back().name = name;
    c.estimated.push_back(name);
    for (BudgetLine& line : c.budget) line.share.push_back(0.25), line.contribution.push_back(0.001);
    c.jackknife[0].push_back(M.value);
  }
  c.jackknife[0].back() = M.value - 2.5 * M.u;
  const std::string text = ToText(c, false), wide = ToText(c);
  EXPECT_THAT(text, StartsWith("status: ok\n"));
  EXPECT_THAT(text, AllOf(HasSubstr("without target left c moves most: by -2.50 u\n"), HasSubstr("--wide"),
                          Not(HasSubstr("u naive")), Not(HasSubstr("moves by, without"))));
  EXPECT_THAT(wide, AllOf(HasSubstr("u naive"), HasSubstr("moves by, without"), Not(HasSubstr("--wide"))));
}

TEST(TextTest, OneLineSumsUpTheVolume) {
  Calibration c = WithBudgetAndVolume();
  const std::string of_points = "expanded uncertainty of a measured point over the scanned volume: ";
  EXPECT_THAT(ToText(c), HasSubstr(of_points + "0.031 to 0.31 mm, largest at alpha = 14.3 deg, y = 160 mm; the noise"));
  c.volume.rows[0].back() = c.volume.rows[1].back();
  EXPECT_THAT(ToText(c), HasSubstr(of_points + "0.31 mm throughout; the noise"));
  c.volume = {};
  EXPECT_THAT(ToText(c), Not(HasSubstr("volume")));
}

TEST(TextTest, DeclaredInfluencesDropTheFootnote) {
  Calibration c = SomeCalibration();
  c.budget.push_back({{"scale_y"}, 'B', Unit::kOne, 1e-4, {}, {0.001, 0.002}, {0.01, 0.01}, 1e9});
  EXPECT_THAT(ToText(c), Not(HasSubstr("traceable")));
}

TEST(TextTest, TheReasonsOfAnUnreliableResultComeLast) {
  Calibration c = SomeCalibration();
  c.unreliable = {Sentence{"the refinement did not converge"}};
  EXPECT_THAT(ToText(c), HasSubstr("unreliable: the refinement did not converge\nstatus: unreliable\n"));
}

TEST(TextTest, ARowThatWasLeftOutIsExplained) {
  Comparison comparison{{{"M/mm", 6}, {"N/mm", 6}, {"s", 2}}, {}};
  comparison.rows.push_back({{"grid, step 0.001"}, {}, {"left out: 1e+09 nodes"}});
  comparison.rows.push_back({{"joint, depth"}, {{123.0021, 0.011}, {409.1, 0.02}, {std::nullopt}}, {}});
  const std::string text = ToText(comparison);
  EXPECT_THAT(text, AllOf(HasSubstr("grid, step 0.001: left out: 1e+09 nodes\n"), HasSubstr("123.002(11)"),
                          HasSubstr("409.100(20)"), HasSubstr("M/mm")));
}

}  // namespace
}  // namespace scancal
