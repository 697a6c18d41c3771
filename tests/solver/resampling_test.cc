#include "solver/uncertainty/resampling.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numeric>
#include "solver/uncertainty/covariance.h"
#include "tests/solver/line_model.h"

namespace scancal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double k95 = 1.959963984540054;

Solution Solved(const LineScene& scene) {
  LineModel model;
  model.quantity(LineModel::kCurvature).role = Role::kEstimate;
  model.quantity(LineModel::kNoise).role = Role::kConsider;
  model.quantity(LineModel::kNoise).u = scene.noise;
  Problem problem = MakeProblem<LineModel>(std::make_shared<LineModel>(model), scene.Make());
  problem.WeighEqually(scene.noise);
  const Estimate start = NominalStart(problem);
  Solution solution = Solve(std::move(problem), start);
  solution.variances.emplace();  // none was estimated: the noise is declared
  return solution;
}

// With the U that the noise gives, times a factor; a held parameter in between.
Calibration Stated(const Solution& solution, double factor) {
  const Eigen::MatrixXd covariance = InverseInformation(solution.linear);
  Calibration result;
  for (const char* name : {"slope", "held", "curvature"}) {
    Parameter& p = result.parameters.emplace_back();
    p.name = name;
    if (p.name == "held") continue;
    const Eigen::Index k = p.name == "slope" ? 0 : 1;
    p.role = Role::kEstimate;
    p.value = solution.fit.estimate.system[k];
    p.u = std::sqrt(covariance(k, k));
    p.k = k95;
    p.U = k95 * p.u * factor;
  }
  return result;
}

// u is 0.022 and 0.0040: half a digit is 0.22 u and 0.13 u, and two standard errors of an end are 0.053 u.
TEST(AddResampling, ConfirmsAnIntervalThatIsRight) {
  const Solution solution = Solved({});
  Calibration result = Stated(solution, 1);
  double last = 0;
  AddResampling(
      solution, {.trials = 10'000}, [&](double done) { last = done; }, &result);
  EXPECT_GT(last, 0.9);
  EXPECT_LE(last, 1);
  const MonteCarloSummary& summary = result.monte_carlo;
  EXPECT_EQ(summary.trials, 10'000);
  EXPECT_EQ(summary.failed, 0);
  EXPECT_EQ(summary.digits, 1);
  ASSERT_EQ(summary.parameters.size(), 2u);
  for (const MonteCarloParameter& p : summary.parameters) {
    const Parameter& stated = *result.Find(p.name);
    EXPECT_EQ(p.verdict, "PASS") << p.name;
    EXPECT_NEAR(p.mean, stated.value, 4 * stated.u / 100);
    EXPECT_NEAR(p.deviation, stated.u, 4 * stated.u / std::sqrt(2e4));
    EXPECT_NEAR(p.low, stated.value - stated.U, 4 * 0.0267 * stated.u);
    EXPECT_NEAR(p.high, stated.value + stated.U, 4 * 0.0267 * stated.u);
    EXPECT_EQ(p.gum_low, stated.value - stated.U);
    EXPECT_EQ(p.gum_high, stated.value + stated.U);
    ASSERT_EQ(p.edges.size(), p.counts.size() + 1);
    EXPECT_TRUE(std::is_sorted(p.edges.begin(), p.edges.end()));
    EXPECT_EQ(std::accumulate(p.counts.begin(), p.counts.end(), 0.0), 10'000);
    EXPECT_GT(p.counts[p.counts.size() / 2], 200);
    EXPECT_NEAR(stated.u_bootstrap, stated.u, 0.5 * stated.u);
  }
  EXPECT_EQ(summary.parameters[1].name, "curvature");
  EXPECT_THAT(result.warnings, IsEmpty());
}

TEST(AddResampling, WarnsOfAnIntervalThatIsWrong) {
  const Solution solution = Solved({});
  Calibration result = Stated(solution, 0.5);
  AddResampling(solution, {.trials = 2000}, {}, &result);
  EXPECT_EQ(result.monte_carlo.parameters[0].verdict, "FAIL");
  EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("slope: value +- U and the 95 % interval of Monte Carlo differ"),
                                           HasSubstr("curvature: ")));
  EXPECT_TRUE(result.ok());
}

TEST(AddResampling, DoesNotPassTwoDigitsInAHurry) {
  const Solution solution = Solved({});
  Calibration result = Stated(solution, 1);
  AddResampling(solution, {.trials = 10'000, .digits = 2}, {}, &result);
  EXPECT_FALSE(result.monte_carlo.stable);
  EXPECT_EQ(result.monte_carlo.trials, 10'000);
  for (const MonteCarloParameter& p : result.monte_carlo.parameters) EXPECT_EQ(p.verdict, "UNDECIDED");
  EXPECT_THAT(result.warnings, IsEmpty());
}

TEST(AddResampling, DrawsNothingUnlessAsked) {
  const Solution solution = Solved({});
  Calibration result = Stated(solution, 1);
  AddResampling(solution, {}, {}, &result);
  EXPECT_EQ(result.monte_carlo.trials, 0);
  EXPECT_THAT(result.monte_carlo.parameters, IsEmpty());
  EXPECT_GT(result.Find("slope")->u_bootstrap, 0);
  EXPECT_EQ(result.Find("held")->u_bootstrap, 0);
}

}  // namespace
}  // namespace scancal
