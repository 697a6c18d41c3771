#include <gtest/gtest.h>
#include "solver/refine.h"
#include "solver/uncertainty/covariance.h"
#include "solver/uncertainty/resampling.h"
#include "tests/solver/line_model.h"

namespace scancal {
namespace {

constexpr int kReplicates = 2000;
constexpr double kOfReplicates = 4 / 63.0;  // four standard deviations of a standard deviation: 4 / sqrt(4000)

struct Fitted {
  Problem problem;
  Linearization linear;
};

Fitted FitOf(const LineScene& scene, const LineModel& model = {}) {
  Problem problem = MakeProblem<LineModel>(std::make_shared<LineModel>(model), scene.Make());
  problem.WeighEqually(scene.noise);
  const Fit fit = Refine(problem, NominalStart(problem));
  Linearization linear = Linearize(problem, fit.estimate, Storey::kViews);
  return {std::move(problem), std::move(linear)};
}

double ToClustered(const Fitted& f, Eigen::Index k = 0) {
  const Bootstrap bootstrap = ResampleViews(f.problem, f.linear, kReplicates, 1);
  EXPECT_EQ(bootstrap.replicates, kReplicates);
  return std::sqrt(bootstrap.covariance(k, k) / ClusteredCovariance(f.problem, f.linear).matrix(k, k));
}

// With 60 views a target the leverage of a view is about 1 / 60: the bootstrap is 1 % smaller, and the two differ from
// set to set by less than that.
TEST(Bootstrap, IsTheClusteredFigureOnWhiteNoise) {
  LineScene scene;
  scene.views = 60;
  EXPECT_NEAR(ToClustered(FitOf(scene)), 1, kOfReplicates + 0.02);
}

TEST(Bootstrap, IsTheClusteredFigureWhenViewsShareAnError) {
  LineScene scene;
  scene.views = 60;
  scene.shift = 0.3;
  LineModel model;
  model.quantity(LineModel::kCurvature).role = Role::kEstimate;
  const Fitted f = FitOf(scene, model);
  for (const Eigen::Index k : {0, 1}) EXPECT_NEAR(ToClustered(f, k), 1, kOfReplicates + 0.02) << k;
  EXPECT_GT(ResampleViews(f.problem, f.linear, 200, 1).covariance(0, 0),
            2 * NaiveCovariance(f.problem, f.linear).matrix(0, 0));
}

TEST(Bootstrap, KeepsPriors) {
  LineModel model;
  model.quantity(LineModel::kSlope).value = 0.3;
  model.quantity(LineModel::kSlope).u = 1e-3;  // a tenth of what the data say
  LineScene scene;
  scene.views = 60;
  scene.shift = 0.3;
  const Fitted with = FitOf(scene, model), without = FitOf(scene);
  const double information = InverseInformation(with.linear)(0, 0) / InverseInformation(without.linear)(0, 0);
  const double found = std::sqrt(ResampleViews(with.problem, with.linear, kReplicates, 1).covariance(0, 0) /
                                 ResampleViews(without.problem, without.linear, kReplicates, 1).covariance(0, 0));
  EXPECT_NEAR(found / information, 1, 0.1);  // the data's pull shrinks as their part; the same draws on either side
}

TEST(Bootstrap, IsTheSameForTheSameSeed) {
  const Fitted f = FitOf({});
  const Eigen::MatrixXd first = ResampleViews(f.problem, f.linear, 100, 3).covariance;
  EXPECT_EQ(ResampleViews(f.problem, f.linear, 100, 3).covariance, first);
  EXPECT_NE(ResampleViews(f.problem, f.linear, 100, 4).covariance, first);
}

TEST(Bootstrap, LeavesOutReplicatesThatDetermineTooLittle) {
  LineScene scene;
  scene.targets = 1;
  scene.views = 2;
  scene.points = 1;  // two points: each is drawn twice in half of the replicates
  const Fitted f = FitOf(scene);
  const Bootstrap bootstrap = ResampleViews(f.problem, f.linear, 1000, 1);
  EXPECT_NEAR(bootstrap.replicates, 500, 4 * std::sqrt(250));
  EXPECT_TRUE(bootstrap.covariance.allFinite());
  LineModel model;
  model.quantity(LineModel::kLevel).u = 1;  // with a prior of the level, which is always kept, one point will do,
  const Fitted both = FitOf(scene, model);  // but for the one at x = 0
  EXPECT_NEAR(ResampleViews(both.problem, both.linear, 1000, 1).replicates, 750, 4 * std::sqrt(1000 * 0.75 * 0.25));
  scene.views = 1;
  const Fitted none = FitOf(scene);
  EXPECT_EQ(ResampleViews(none.problem, none.linear, 10, 1).covariance.size(), 0);
}

}  // namespace
}  // namespace scancal
