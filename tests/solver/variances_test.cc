// Restricted maximum likelihood against closed forms, and the statements built on it against their own Monte Carlo.
#include "solver/uncertainty/variances.h"
#include <gtest/gtest.h>
#include <Eigen/Dense>
#include "solver/calibrate.h"
#include "solver/uncertainty/misfit.h"
#include "solver/weigh.h"
#include "tests/solver/line_model.h"

namespace scancal {
namespace {

constexpr double kLeast = 1e-9;

struct Roles {
  Role shift = Role::kEstimate, noise = Role::kEstimate;
  double u_shift = 0, u_noise = 0;
};

Problem LineProblem(std::vector<LineModel::Target> targets, const Roles& roles) {
  LineModel model;
  model.quantity(LineModel::kShift).role = roles.shift;
  model.quantity(LineModel::kShift).u = roles.u_shift;
  model.quantity(LineModel::kNoise).role = roles.noise;
  model.quantity(LineModel::kNoise).u = roles.u_noise;
  return MakeProblem<LineModel>(std::make_shared<LineModel>(model), std::move(targets));
}

Solution Weighted(Problem problem) {
  const Estimate start = NominalStart(problem);
  return SolveWeighted(Solve(std::move(problem), start), kLeast);
}

double VarianceOf(const Variances& variances, const std::string& source) {
  for (size_t k = 0; k < variances.sources.size(); ++k)
    if (variances.sources[k] == source) return variances.variance[static_cast<Eigen::Index>(k)];
  ADD_FAILURE() << source << " was not estimated";
  return 0;
}

// Every view on the same abscissae: then the restricted likelihood has the mean squares of an analysis of variance.
std::vector<LineModel::Target> Balanced(LineScene scene) {
  std::vector<LineModel::Target> targets = scene.Make();
  for (LineModel::Target& target : targets)
    for (LineModel::View& view : target.views)
      for (size_t i = 0; i < view.x.size(); ++i) {
        view.y[i] -= scene.slope * view.x[i];
        view.x[i] = 0.1 * static_cast<double>(i);
        view.y[i] += scene.slope * view.x[i];
      }
  return targets;
}

TEST(Variances, OfABalancedDesignAreItsMeanSquares) {
  LineScene scene;
  scene.shift = 0.2;
  const auto targets = Balanced(scene);
  const Variances variances = *Weighted(LineProblem(targets, {})).variances;
  const double n = scene.points, views = scene.targets * scene.views;
  double sxx = 0, sxy = 0, within = 0, between = 0;
  for (const auto& target : targets) {
    double grand = 0;
    std::vector<double> means;
    for (const auto& view : target.views) {
      const Eigen::Map<const Eigen::ArrayXd> x(view.x.data(), scene.points), y(view.y.data(), scene.points);
      means.push_back(y.mean());
      grand += y.mean() / scene.views;
      sxx += (x - x.mean()).square().sum();
      sxy += ((x - x.mean()) * (y - y.mean())).sum();
      within += (y - y.mean()).square().sum();
    }
    for (const double mean : means) between += n * std::pow(mean - grand, 2);
  }
  const double noise = (within - sxy * sxy / sxx) / (views * (n - 1) - 1);
  const double shift = (between / (views - scene.targets) - noise) / n;
  EXPECT_NEAR(VarianceOf(variances, "noise"), noise, 1e-5 * noise);
  EXPECT_NEAR(VarianceOf(variances, "shift"), shift, 1e-4 * shift);
  EXPECT_NEAR(variances.Dof("noise"), views * (n - 1) - 1, 1e-3 * views * n);
}

TEST(Variances, OfWhiteNoiseAloneHasTheDegreesOfFreedomOfTheFit) {
  const LineScene scene;
  Roles roles;
  roles.shift = Role::kHold;
  const Solution solution = Weighted(LineProblem(scene.Make(), roles));
  const double dof = scene.targets * scene.views * scene.points - 1 - scene.targets;
  EXPECT_NEAR(solution.variances->Dof("noise"), dof, 1e-6 * dof);
  const Calibration result = Summarize(solution, {});
  EXPECT_NEAR(result.parameters[0].dof, dof, 1e-6 * dof);
  EXPECT_NEAR(result.parameters[0].u, result.parameters[0].u_naive, 1e-6 * result.parameters[0].u);
}

TEST(Variances, ThatAreNotThereBecomeZeroAndLeaveTheOthersRight) {
  int zero = 0;
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    LineScene scene;
    scene.seed = seed;
    const Variances variances = *Weighted(LineProblem(scene.Make(), {})).variances;
    EXPECT_TRUE(variances.converged) << "seed " << seed;
    EXPECT_NEAR(VarianceOf(variances, "noise"), 0.01, 5 * 0.01 * std::sqrt(2 / 116.0));
    zero += VarianceOf(variances, "shift") < 1e-6;
  }
  EXPECT_GT(zero, 8);  // half of the times on average
  EXPECT_LT(zero, 32);
}

TEST(Variances, DeclaredOnesAreKeptUnlessTheResidualsShowMore) {
  LineScene scene;
  scene.views = 30;
  scene.shift = 0.3;
  Roles roles;
  roles.shift = Role::kConsider;
  roles.u_shift = 0.4;  // careful: kept
  const Solution careful = Weighted(LineProblem(scene.Make(), roles));
  EXPECT_TRUE(careful.variances->exceeded.empty());
  EXPECT_EQ(careful.problem.quantities[LineModel::kShift].u, 0.4);
  EXPECT_EQ(careful.variances->sources, std::vector<std::string>{"noise"});
  roles.u_shift = 0.05;
  const Solution careless = Weighted(LineProblem(scene.Make(), roles));
  ASSERT_EQ(careless.variances->exceeded.size(), 1U);
  EXPECT_EQ(careless.variances->exceeded[0].source, "shift");
  EXPECT_EQ(careless.variances->exceeded[0].declared, 0.05);
  EXPECT_NEAR(careless.variances->exceeded[0].estimated, 0.3, 0.1);
  EXPECT_EQ(careless.variances->exceeded[0].estimated, careless.problem.quantities[LineModel::kShift].u);
  const Calibration result = Summarize(careless, {});
  ASSERT_EQ(result.unreliable.size(), 1U);  // six times as much is no chance
  EXPECT_EQ(result.unreliable[0].english.find("shift: declared with u = 0.05"), 0U) << result.unreliable[0];
  roles.u_shift = 0.28;  // less than 1.3 times as much may be used, and is told
  const Calibration doubted = Summarize(Weighted(LineProblem(scene.Make(), roles)), {});
  EXPECT_TRUE(doubted.unreliable.empty());
}

TEST(Variances, AllDeclaredMeansInfiniteDegreesOfFreedom) {
  LineScene scene;
  scene.shift = 0.3;
  const Solution solution = Weighted(LineProblem(scene.Make(), {Role::kConsider, Role::kConsider, 0.3, 0.1}));
  EXPECT_TRUE(solution.variances->sources.empty());
  const Calibration result = Summarize(solution, {});
  EXPECT_NEAR(result.parameters[0].k, 1.959964, 1e-5);
  for (const BudgetLine& line : result.budget) EXPECT_EQ(line.type, 'B');
}

TEST(Variances, ThatCannotBeToldApartKeepTheirSum) {
  LineScene scene;
  scene.points = 1;  // one point a view: its noise is the view's shift
  scene.views = 200;
  scene.shift = 0.3;
  const Variances variances = *Weighted(LineProblem(scene.Make(), {})).variances;
  EXPECT_TRUE(variances.converged);
  EXPECT_NEAR(VarianceOf(variances, "noise") + VarianceOf(variances, "shift"), 0.1, 5 * 0.1 * std::sqrt(2 / 596.0));
}

TEST(Variances, OfNoiselessDataAreNone) {
  LineScene scene;
  scene.noise = 0;
  const Solution solution = Weighted(LineProblem(scene.Make(), {}));
  EXPECT_NEAR(solution.fit.estimate.system[0], scene.slope, 1e-12);
  const Calibration result = Summarize(solution, {});
  EXPECT_LT(result.parameters[0].u, 1e-8);
  EXPECT_TRUE(result.unreliable.empty()) << result.unreliable[0];
}

TEST(Variances, DoNotDependOnTheOrder) {
  LineScene scene;
  scene.shift = 0.2;
  auto targets = scene.Make();
  const Solution forward = Weighted(LineProblem(targets, {}));
  std::reverse(targets.begin(), targets.end());
  for (auto& target : targets) std::reverse(target.views.begin(), target.views.end());
  const Solution backward = Weighted(LineProblem(targets, {}));
  EXPECT_NEAR(forward.fit.estimate.system[0], backward.fit.estimate.system[0], 1e-9);
  EXPECT_LT((forward.variances->variance - backward.variances->variance).norm(), 1e-9);
}

// Few views, so that the degrees of freedom matter: how often do +-k u hold the truth?
TEST(Variances, TheStatedIntervalHoldsTheTruthAsOftenAsItSays) {
  constexpr int kTrials = 1500;
  LineScene scene;
  scene.targets = 2;
  scene.views = 8;
  scene.shift = 0.15;
  int held = 0;
  double scatter = 0, stated = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    scene.seed = static_cast<uint64_t>(trial) + 1;
    const Calibration result = Summarize(Weighted(LineProblem(scene.Make(), {})), {});
    const Parameter& slope = result.parameters[0];
    held += std::abs(slope.value - scene.slope) <= slope.U;
    scatter += std::pow(slope.value - scene.slope, 2) / kTrials;
    stated += slope.u * slope.u / kTrials;
  }
  const double standard_error = std::sqrt(0.95 * 0.05 / kTrials);
  EXPECT_NEAR(static_cast<double>(held) / kTrials, 0.95, 4 * standard_error);
  EXPECT_NEAR(std::sqrt(stated / scatter), 1, 4 / std::sqrt(2.0 * kTrials) + 0.02);  // u^2 is unbiased to second order
}

TEST(Weigh, DividesEveryViewByItsOwnCovariance) {
  LineScene scene;
  Problem problem = LineProblem(scene.Make(), {Role::kConsider, Role::kConsider, 0.3, 0.1});
  Weigh(&problem, NominalStart(problem));
  const Eigen::MatrixXd& mix = problem.targets[1].views[2].mix;
  const Eigen::MatrixXd v =
      0.01 * Eigen::MatrixXd::Identity(5, 5) + 0.09 * Eigen::MatrixXd::Ones(5, 5);  // shift: common to the points
  EXPECT_LT((mix * v * mix.transpose() - Eigen::MatrixXd::Identity(5, 5)).norm(), 1e-12);
}

// Shifts of views as a random walk that forgets: neighbours have correlation 0.7.
TEST(Neighbours, AreToldWhenTheyAreNotIndependent) {
  LineScene scene;
  scene.views = 100;
  scene.noise = 0.03;
  for (const double correlation : {0.0, 0.7}) {
    auto targets = scene.Make();
    Random random(7, 0);
    for (auto& target : targets) {
      double shift = random.Normal();
      for (auto& view : target.views) {
        shift = correlation * shift + std::sqrt(1 - correlation * correlation) * random.Normal();
        for (double& y : view.y) y += 0.3 * shift;
      }
    }
    const Calibration result = Summarize(Weighted(LineProblem(targets, {})), {});
    EXPECT_NEAR(result.neighbours, correlation, 4 / std::sqrt(297.0));
    EXPECT_EQ(result.unreliable.size(), correlation > 0 ? 1U : 0U);  // u is too small by more than two
  }
}

std::vector<MisfitTest> Misfits(const LineScene& scene, double u_curvature = 0) {
  Problem problem = LineProblem(scene.Make(), {Role::kHold, Role::kEstimate});
  problem.quantities[LineModel::kCurvature].role = u_curvature > 0 ? Role::kConsider : Role::kHold;
  problem.quantities[LineModel::kCurvature].u = u_curvature;
  const Solution solution = Weighted(std::move(problem));
  return TestMisfits(solution.problem, solution.fit.estimate, solution.linear, 20);
}

TEST(Misfit, SaysWhatAHeldQuantityShouldBe) {
  LineScene scene;
  scene.curvature = 0.05;
  const std::vector<MisfitTest> misfits = Misfits(scene);
  ASSERT_EQ(misfits.size(), 1U);
  EXPECT_EQ(misfits[0].source, "curvature");
  EXPECT_LT(misfits[0].p, 1e-6);
  // What a fit gives that estimates it.
  Problem problem = LineProblem(scene.Make(), {Role::kHold, Role::kEstimate});
  problem.quantities[LineModel::kCurvature].role = Role::kEstimate;
  const Solution both = Weighted(problem), one = Weighted(LineProblem(scene.Make(), {Role::kHold, Role::kEstimate}));
  EXPECT_NEAR(misfits[0].size, both.fit.estimate.system[1], 1e-9);
  EXPECT_NEAR(misfits[0].moves[0], both.fit.estimate.system[0] - one.fit.estimate.system[0], 1e-9);
}

TEST(Misfit, OfASoundModelHasTheDistributionOfF) {
  constexpr int kTrials = 600;
  LineScene scene;
  double mean = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    scene.seed = static_cast<uint64_t>(trial) + 1;
    mean += Misfits(scene)[0].F / kTrials;
  }
  EXPECT_NEAR(mean, 1, 4 * std::sqrt(2.0 / kTrials));
}

TEST(Misfit, AllowsForADeclaredUncertainty) {
  LineScene scene;
  scene.curvature = 0.05;
  EXPECT_GT(Misfits(scene, 0.04)[0].p, 1e-3);
  EXPECT_LT(Misfits(scene, 0.004)[0].p, 1e-3);
}

}  // namespace
}  // namespace scancal
