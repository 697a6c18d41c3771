#include "solver/uncertainty/neighbours.h"
#include <gtest/gtest.h>
#include <cmath>
#include "solver/calibrate.h"
#include "solver/uncertainty/covariance.h"
#include "solver/uncertainty/jackknife.h"
#include "solver/uncertainty/misfit.h"
#include "tests/solver/line_model.h"

namespace scancal {
namespace {

constexpr double kShift = 0.3, kNoise = 0.03;

LineScene Correlated(double correlation, uint64_t seed) {
  LineScene scene;
  scene.views = 40;
  scene.noise = kNoise;
  scene.shift = kShift;
  scene.shift_correlation = correlation;
  scene.seed = seed;
  return scene;
}

// curvature: a line's own, and held.
Problem ProblemOf(const LineScene& scene, Role noise) {
  auto model = std::make_shared<LineModel>();
  model->quantity(LineModel::kCurvature).scope = Scope::kTarget;
  model->quantity(LineModel::kShift).role = model->quantity(LineModel::kNoise).role = noise;
  model->quantity(LineModel::kShift).in_order = true;
  if (noise == Role::kConsider) {
    model->quantity(LineModel::kShift).u = kShift;
    model->quantity(LineModel::kShift).neighbour = scene.shift_correlation;
    model->quantity(LineModel::kNoise).u = kNoise;
  }
  Problem problem = MakeProblem<LineModel>(model, scene.Make());
  problem.WeighEqually(kNoise);
  return problem;
}

TEST(AcrossNeighbours, TestsOfTheModelHaveTheDistributionOfF) {
  constexpr int kTrials = 250;
  for (const double correlation : {0.0, 0.8}) {
    double misfit = 0, misfit_dof = 0, target = 0, target_dof = 0, jackknife = 0, expected = 0;
    for (int trial = 1; trial <= kTrials; ++trial) {
      Problem problem = ProblemOf(Correlated(correlation, static_cast<uint64_t>(trial)), Role::kConsider);
      const Solution solution = SolveWeighted(Solve(problem, NominalStart(problem)), 1e-9);
      const MisfitTest test = TestMisfits(solution.problem, solution.fit.estimate, solution.linear, 1e6)[0];
      misfit += test.F / kTrials;
      misfit_dof = test.dof1;
      const std::vector<TargetTest> targets =
          TestTargets(solution.problem, solution.fit.estimate, solution.linear, 1e6);
      target += targets[1].F / kTrials;
      target_dof = targets[1].dof1;
      jackknife += LeaveOneTargetOut(solution.problem, solution.fit, solution.linear).covariance(0, 0);
      expected += ExpectLeaveOneTargetOut(solution.problem, solution.fit.estimate, solution.linear).variance[0];
    }
    EXPECT_EQ(misfit_dof, 3);
    EXPECT_NEAR(misfit, 1, 4 * std::sqrt(2 / misfit_dof / kTrials)) << correlation;
    EXPECT_NEAR(target, 1, 4 * std::sqrt(2 / target_dof / kTrials)) << correlation;
    EXPECT_NEAR(jackknife / expected, 1, 4 * std::sqrt(1.0 / kTrials)) << correlation;  // of two degrees of freedom
  }
}

TEST(TestTargets, FindsTheOneThatContradicts) {
  LineScene scene = Correlated(0, 1);
  auto lines = scene.Make();
  for (LineModel::View& view : lines[2].views)
    for (size_t i = 0; i < view.x.size(); ++i) view.y[i] += 0.1 * view.x[i];
  auto model = std::make_shared<LineModel>();
  model->quantity(LineModel::kShift).role = model->quantity(LineModel::kNoise).role = Role::kEstimate;
  Problem problem = MakeProblem<LineModel>(model, lines);
  problem.WeighEqually(kNoise);
  const Solution solution = SolveWeighted(Solve(problem, NominalStart(problem)), 1e-9);
  const std::vector<TargetTest> tests = TestTargets(solution.problem, solution.fit.estimate, solution.linear, 100);
  ASSERT_EQ(tests.size(), 3U);
  EXPECT_LT(tests[2].p, 1e-6);
  EXPECT_LT(tests[2].p, std::min(tests[0].p, tests[1].p));
}

TEST(EstimateNeighbours, FindsTheCorrelationAndTheSize) {
  constexpr int kTrials = 40;
  constexpr double kCorrelation = 0.7;
  double u = 0, rho = 0;
  int found = 0;
  for (int trial = 1; trial <= kTrials; ++trial) {
    const Problem problem = ProblemOf(Correlated(kCorrelation, static_cast<uint64_t>(trial)), Role::kEstimate);
    const Solution solution = SolveWeighted(Solve(problem, NominalStart(problem)), 1e-9);
    const Quantity& shift = solution.problem.quantities[LineModel::kShift];
    if (shift.neighbour == 0) continue;
    ++found;
    u += shift.u;
    rho += shift.neighbour;
  }
  EXPECT_GE(found, kTrials - 1);
  // Of 120 views: (1 - rho^2) / n for rho (Box and Jenkins 1970, 7.2), (1 + rho^2) / (1 - rho^2) / 2n for log u; a bias
  // of (1 + 3 rho) / n besides (Kendall 1954), as each line has a level and slope of its own.
  const double n = 120, of_rho = std::sqrt((1 - kCorrelation * kCorrelation) / n / kTrials),
               of_u = kShift * std::sqrt((1 + kCorrelation * kCorrelation) / (1 - kCorrelation * kCorrelation) / 2 / n /
                                         kTrials);
  EXPECT_NEAR(rho / found, kCorrelation, 4 * of_rho + (1 + 3 * kCorrelation) / n);
  EXPECT_NEAR(u / found, kShift, 4 * of_u + kShift / n * (1 + kCorrelation) / (1 - kCorrelation));
}

// A line that is bent is no noise of its views.
TEST(EstimateNeighbours, LeavesSmoothErrorsOfATarget) {
  LineScene scene = Correlated(0, 3);
  scene.curvature = 0.01;
  const Problem problem = ProblemOf(scene, Role::kEstimate);
  const Solution solution = SolveWeighted(Solve(problem, NominalStart(problem)), 1e-9);
  EXPECT_EQ(solution.problem.quantities[LineModel::kShift].neighbour, 0);
  ASSERT_EQ(solution.neighbours.what, NeighboursFound::kSmooth);
  EXPECT_EQ(solution.neighbours.source, "curvature");
  EXPECT_GT(solution.neighbours.u, 0.005);  // of three lines, each with 0.01
  EXPECT_LT(solution.neighbours.u, 0.02);
}

// Views that wander as one sum of steps, by less than their own scatter: no lag alone shows it.
TEST(EstimateNeighbours, SaysWhatIsTooSlowForNoise) {
  LineScene scene = Correlated(0, 5);
  scene.views = 100;
  scene.shift = 0.1;
  auto lines = scene.Make();
  Random random(6, 0);
  for (LineModel::Target& line : lines) {
    double wandered = 0;
    for (LineModel::View& view : line.views) {
      wandered += 0.03 * random.Normal();
      for (double& y : view.y) y += wandered;
    }
  }
  auto model = std::make_shared<LineModel>();
  model->quantity(LineModel::kShift).role = model->quantity(LineModel::kNoise).role = Role::kEstimate;
  model->quantity(LineModel::kShift).in_order = true;
  Problem problem = MakeProblem<LineModel>(model, std::move(lines));
  problem.WeighEqually(kNoise);
  const Solution solution = SolveWeighted(Solve(problem, NominalStart(problem)), 1e-9);
  EXPECT_NE(solution.neighbours.what, NeighboursFound::kNone);
  const Calibration result = Summarize(solution, {});
  const double u_if_independent = std::sqrt(InverseInformation(solution.linear)(0, 0));
  EXPECT_TRUE(!result.unreliable.empty() || result.Find("slope")->u > 2 * u_if_independent);
}

TEST(CorrelationOfNeighbours, SuspectsNoIndependentViews) {
  constexpr int kTrials = 200;
  int suspected = 0;
  for (int trial = 1; trial <= kTrials; ++trial) {
    const Problem problem = ProblemOf(Correlated(0, static_cast<uint64_t>(trial)), Role::kEstimate);
    const Solution solution = SolveWeighted(Solve(problem, NominalStart(problem)), 1e-9);
    suspected += CorrelationOfNeighbours(solution.problem, solution.fit.estimate, solution.linear).IsSuspected();
  }
  EXPECT_LE(suspected, 3);  // three tries a set at four standard deviations, a few of them correlated: 1e-4 a set
}

}  // namespace
}  // namespace scancal
