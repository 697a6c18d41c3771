// Every covariance meets its own Monte Carlo, on a model that is no scanner.
#include <gtest/gtest.h>
#include <Eigen/Dense>
#include "solver/calibrate.h"
#include "solver/dense.h"
#include "solver/uncertainty/budget.h"
#include "solver/uncertainty/covariance.h"
#include "solver/uncertainty/gum.h"
#include "tests/solver/line_model.h"

namespace scancal {
namespace {

constexpr int kTrials = 2000;
constexpr double kTolerance =
    4 / 63.0;  // four standard deviations of a standard deviation from 2000 trials: 4 / sqrt(4000)

struct Averages {
  double scatter = 0, naive = 0, clustered = 0;  // standard deviations of the slope
};

Averages Study(LineScene scene) {
  Averages result;
  double sum = 0, squares = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    scene.seed = static_cast<uint64_t>(trial) + 1;
    const Problem problem = MakeProblem<LineModel>(std::make_shared<LineModel>(), scene.Make());
    const Linearization linear = Linearize(problem, NominalStart(problem), Storey::kViews);
    Estimate fit = GaussNewtonStep(linear);  // the model is linear: one step from zero is the fit
    const Linearization there = Linearize(problem, fit, Storey::kViews);
    const double error = fit.system[0] - scene.slope;
    sum += error;
    squares += error * error;
    result.naive += NaiveCovariance(problem, there).matrix(0, 0) / kTrials;
    result.clustered += ClusteredCovariance(problem, there).matrix(0, 0) / kTrials;
  }
  EXPECT_NEAR(sum / kTrials, 0, 4 * std::sqrt(squares) / kTrials);
  return {std::sqrt(squares / kTrials), std::sqrt(result.naive), std::sqrt(result.clustered)};
}

TEST(Covariance, BothAreRightOnWhiteNoiseEvenWithFewViews) {
  LineScene scene;
  scene.targets = 2;
  scene.views = 3;  // high leverage: without its correction the clustered one would be a third too small
  const Averages study = Study(scene);
  EXPECT_NEAR(study.naive / study.scatter, 1, kTolerance);
  EXPECT_NEAR(study.clustered / study.scatter, 1, kTolerance);
}

TEST(Covariance, OnlyTheClusteredOneIsRightWhenViewsShareAnError) {
  LineScene scene;
  scene.views = 20;
  scene.shift = 0.3;
  const Averages study = Study(scene);
  EXPECT_LT(study.naive / study.scatter, 0.6);
  EXPECT_NEAR(study.clustered / study.scatter, 1, kTolerance);
}

TEST(Budget, EqualsTheTextbookForEveryScope) {
  LineModel model;
  const auto consider = [&](int k, double u) {
    model.quantity(k).role = Role::kConsider;
    model.quantity(k).u = u;
  };
  consider(LineModel::kCurvature, 0.01);
  consider(LineModel::kShift, 0.3);
  consider(LineModel::kNoise, 0.1);
  LineScene scene;
  const auto targets = scene.Make();
  const Problem problem = MakeProblem<LineModel>(std::make_shared<LineModel>(model), targets);
  const Estimate fit = Refine(problem, NominalStart(problem)).estimate;
  const Budget budget = BudgetOf(problem, fit, Linearize(problem, fit, Storey::kViews));
  // Dense: J = [x, one column a target], V = noise + shift per view + curvature for all.
  const int rows = 3 * 8 * 5;
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(rows, 4), v = 0.01 * Eigen::MatrixXd::Identity(rows, rows);
  Eigen::VectorXd squared(rows);
  for (int t = 0, i = 0; t < 3; ++t) {
    for (int k = 0; k < 8; ++k) {
      v.block(i, i, 5, 5).array() += 0.09;
      for (int p = 0; p < 5; ++p, ++i) {
        const double x = targets[t].views[k].x[p];
        j(i, 0) = x;
        j(i, 1 + t) = 1;
        squared[i] = x * x;
      }
    }
  }
  v += 1e-4 * squared * squared.transpose();
  const Eigen::MatrixXd gain = LeastSquares(j, Eigen::MatrixXd::Identity(j.rows(), j.rows()));
  const double expected = (gain * v * gain.transpose())(0, 0);
  EXPECT_NEAR(budget.Total()(0, 0), expected, 1e-12 * expected);
  ASSERT_EQ(budget.lines.size(), 3u);
  for (const Contribution& line : budget.lines) {
    if (line.source != "curvature") continue;
    // The slope that is found falls by as much as a supposed curvature explains.
    EXPECT_NEAR(line.sensitivity[0], -(gain * squared)[0], 1e-12);
    EXPECT_NEAR(std::sqrt(line.covariance(0, 0)), std::abs(line.sensitivity[0]) * 0.01, 1e-14);
  }
}

TEST(Budget, ASourceOfSeveralQuantitiesHasNoSensitivity) {
  LineModel model;
  for (const int k : {LineModel::kCurvature, LineModel::kShift}) {
    model.quantity(k).role = Role::kConsider;
    model.quantity(k).scope = Scope::kSystem;
    model.quantity(k).u = 0.01;
    model.quantity(k).source = "both";
  }
  const Problem problem = MakeProblem<LineModel>(std::make_shared<LineModel>(model), LineScene().Make());
  const Estimate fit = Refine(problem, NominalStart(problem)).estimate;
  const Budget budget = BudgetOf(problem, fit, Linearize(problem, fit, Storey::kViews));
  ASSERT_EQ(budget.lines.size(), 1u);
  EXPECT_EQ(budget.lines[0].sensitivity.size(), 0);
  EXPECT_GT(budget.lines[0].covariance(0, 0), 0);
}

TEST(Summarize, AddsWhatWasConsideredToTheClusteredFigure) {
  LineModel model;
  model.quantity(LineModel::kCurvature).role = Role::kConsider;
  model.quantity(LineModel::kCurvature).u = 0.01;
  const LineScene scene;
  Problem problem = MakeProblem<LineModel>(std::make_shared<LineModel>(model), scene.Make());
  problem.WeighEqually(scene.noise);
  const Estimate start = NominalStart(problem);
  const Calibration result = Summarize(Solve(std::move(problem), start), {});
  ASSERT_EQ(result.estimated, std::vector<std::string>{"slope"});
  const Parameter& slope = *result.Find("slope");
  ASSERT_EQ(result.budget.size(), 2u);
  EXPECT_NEAR(slope.u, std::hypot(slope.u_clustered, result.budget[1].contribution[0]), 1e-14);
  EXPECT_NEAR(slope.U, slope.k * slope.u, 1e-14);
  EXPECT_NEAR(result.sigma, scene.noise, 4 * scene.noise / std::sqrt(2 * 116.0));
  EXPECT_GT(slope.u_naive, 0);
  EXPECT_GT(slope.u_jackknife, 0);
  EXPECT_GT(slope.dof, 24 - 4);  // what was declared is taken as known exactly
}

TEST(Summarize, CountsAPriorOfATargetOnce) {  // it is a cluster of the clustered figure already
  LineModel model;
  model.quantity(LineModel::kLevel).u = 0.05;
  LineScene scene;
  scene.targets = 1;
  Problem problem = MakeProblem<LineModel>(std::make_shared<LineModel>(model), scene.Make());
  problem.WeighEqually(scene.noise);
  const Estimate start = NominalStart(problem);
  const Calibration result = Summarize(Solve(std::move(problem), start), {});
  EXPECT_NEAR(result.Find("slope")->u, result.Find("slope")->u_clustered, 1e-15);
}

// Views of a line's ends that are noisier than the others, which the one variance of all does not say.
TEST(Summarize, TakesWhatViewsShowBeyondTheirNoise) {
  constexpr int kTrials = 300;
  for (const double worse : {1.0, 4.0}) {
    double squares = 0, stated = 0, without = 0;
    int said = 0;
    for (int trial = 1; trial <= kTrials; ++trial) {
      LineScene scene;
      scene.views = 100;
      scene.seed = static_cast<uint64_t>(trial);
      auto lines = scene.Make();
      Random random(scene.seed, 5);
      for (LineModel::Target& line : lines)
        for (int v = 0; v < scene.views; ++v)
          if (v < 10 || v >= scene.views - 10)
            for (double& y : line.views[static_cast<size_t>(v)].y)
              y += std::sqrt(worse * worse - 1) * scene.noise * random.Normal();
      LineModel model;
      model.quantity(LineModel::kNoise).role = Role::kEstimate;
      Problem problem = MakeProblem<LineModel>(std::make_shared<LineModel>(model), std::move(lines));
      const Estimate start = NominalStart(problem);
      const Solution solution = SolveWeighted(Solve(std::move(problem), start), 1e-9);
      const Calibration result = Summarize(solution, {});
      const Parameter& slope = *result.Find("slope");
      squares += std::pow(slope.value - scene.slope, 2) / kTrials;
      stated += slope.u * slope.u / kTrials;
      without += InverseInformation(solution.linear)(0, 0) / kTrials;
      said += !result.warnings.empty() && result.warnings[0].english.find("from view to view") != std::string::npos;
    }
    const double tolerance = 4 * std::sqrt(2.0 / kTrials);
    EXPECT_NEAR(stated / squares, 1, tolerance);
    if (worse > 1) {
      EXPECT_GE(said, 0.95 * kTrials);
      EXPECT_LT(without / squares, 1 - tolerance);
    } else {
      EXPECT_LE(said, 3);  // of 300, each with a chance of 1e-3
    }
  }
}

TEST(CoverageFactor, IsStudentsT) {  // GUM table G.2
  EXPECT_NEAR(CoverageFactor(0.95, 1), 12.71, 0.005);
  EXPECT_NEAR(CoverageFactor(0.95, 4), 2.78, 0.005);
  EXPECT_NEAR(CoverageFactor(0.95, 100), 1.984, 0.0005);
  EXPECT_NEAR(CoverageFactor(0.9545, 20), 2.13, 0.005);
  EXPECT_NEAR(CoverageFactor(0.95, 1e9), 1.960, 0.0005);
  EXPECT_EQ(CoverageFactor(0.95, 0.5), std::numeric_limits<double>::infinity());
}

TEST(FUpperTail, IsTheDistributionOfF) {
  EXPECT_NEAR(FUpperTail(4.26, 2, 9), 0.05, 0.0002);  // tabulated F(0.95; 2, 9)
  EXPECT_NEAR(FUpperTail(1, 10, 10), 0.5, 1e-12);
}

}  // namespace
}  // namespace scancal
