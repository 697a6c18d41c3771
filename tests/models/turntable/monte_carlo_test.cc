// Monte Carlo on the turntable: the fast estimation of a trial is Refine's, and trials scatter as K V K'.
#include "solver/uncertainty/monte_carlo.h"
#include <gtest/gtest.h>
#include "models/turntable/scanner.h"
#include "solver/uncertainty/budget.h"
#include "solver/weigh.h"
#include "tests/models/turntable/scene.h"

namespace scancal::turntable {
namespace {

struct Drawable {
  Problem problem;
  Fit fit;
  Linearization linear;
};

// M, N and tilt_y estimated; noise and jitter considered and whitened; tilt_x and scale_y considered, in no weight.
Drawable MakeDrawable(Model::Residuals residuals) {
  Scene scene;
  scene.profiles = 40;
  scene.points = 20;
  scene.encoder_jitter = 1e-4;
  Model model(residuals);
  model.quantity(Model::kTiltY).role = Role::kEstimate;
  model.quantity(Model::kScaleZ).role = Role::kEstimate;
  model.quantity(Model::kScaleZ).u = 1e-3;
  for (const auto& [k, u] : {std::pair<int, double>{Model::kNoiseY, scene.noise_y},
                             {Model::kEncoderJitter, scene.encoder_jitter},
                             {Model::kTiltX, 2e-3},
                             {Model::kScaleY, 1e-3}}) {
    model.quantity(k).role = Role::kConsider;
    model.quantity(k).u = u;
  }
  Drawable d;
  d.problem = MakeProblemOf(scene, {residuals, true, false, 0}, model);
  d.problem.WeighEqually(scene.noise_y);
  const Estimate start = Refine(d.problem, StartNear(d.problem, scene.system)).estimate;
  for (size_t t = 0; t < d.problem.targets.size(); ++t) {
    const std::vector<double> q = Values(d.problem, start, t);
    for (Block& view : d.problem.targets[t].views) {
      Eigen::VectorXd r;
      Eigen::MatrixXd jitter;
      const int seed = Model::kEncoderJitter;
      Block{view.rows, 1, {}, {}, {}}.Evaluate(q.data(), {&seed, 1}, &r, &jitter);
      Eigen::MatrixXd v = jitter * jitter.transpose() * scene.encoder_jitter * scene.encoder_jitter;
      v.diagonal().array() += scene.noise_y * scene.noise_y;
      view.mix = Whitening(v);
      view.weight = 1;
    }
    d.problem.targets[t].nodes = {};
  }
  d.fit = Refine(d.problem, start);
  d.linear = Linearize(d.problem, d.fit.estimate, Storey::kViews);
  return d;
}

TEST(TurntableMonteCarlo, DerivativesHoldWhereEachPointHasItsOwnNoise) {
  for (const auto residuals : {Model::Residuals::kDepth, Model::Residuals::kPlane}) {
    const Drawable d = MakeDrawable(residuals);
    const Rows& rows = *d.problem.targets[0].views[3].rows;
    std::vector<double> q = Values(d.problem, d.fit.estimate, 0), point(q.size() * static_cast<size_t>(rows.points()));
    for (int i = 0; i < rows.points(); ++i) point[q.size() * static_cast<size_t>(i) + Model::kNoiseY] = 5.0 + i;
    for (const int seed : {Model::kM, Model::kN, Model::kTiltY, Model::kNormal1, Model::kDistance}) {
      Eigen::VectorXd r(rows.size()), jacobian(rows.size()), above(rows.size()), below(rows.size());
      rows.Evaluate(q.data(), point.data(), {&seed, 1}, r.data(), jacobian.data());
      const double h = 1e-4, at = q[seed];
      q[seed] = at + h;
      rows.Evaluate(q.data(), point.data(), {}, above.data(), nullptr);
      q[seed] = at - h;
      rows.Evaluate(q.data(), point.data(), {}, below.data(), nullptr);
      q[seed] = at;
      EXPECT_LT(((above - below) / (2 * h) - jacobian).norm(), 1e-6 * jacobian.norm() + 1e-8) << seed;
      EXPECT_LT(((above + below) / 2 - r).norm(), 1e-4);
    }
  }
}

TEST(TurntableMonteCarlo, ATrialEndsWhereRefineDoes) {
  constexpr int kTrials = 40;
  const VarianceDof dof = {{"noise_y", 20}, {"encoder_jitter", 9}};
  for (const auto residuals : {Model::Residuals::kDepth, Model::Residuals::kPlane}) {
    const Drawable d = MakeDrawable(residuals);
    const Eigen::ArrayXd u = BudgetOf(d.problem, d.fit.estimate, d.linear).Total().diagonal().cwiseSqrt();
    const MonteCarloSample sample = MonteCarlo(d.problem, d.fit, d.linear, dof, {.trials = kTrials, .seed = 5});
    ASSERT_EQ(sample.failed, 0);
    DrawnProblem drawn(d.problem, d.fit.estimate, dof);
    for (int trial = 0; trial < kTrials; ++trial) {
      Random random(5, static_cast<uint64_t>(trial));
      drawn.Draw(&random);
      const Fit refined = Refine(drawn.problem(), d.fit.estimate);
      ASSERT_TRUE(refined.converged) << refined.message;
      const Eigen::ArrayXd apart = (sample.estimates.row(trial).transpose() - refined.estimate.system).array() / u;
      EXPECT_LT(apart.abs().maxCoeff(), 1e-6) << trial << ": " << apart.transpose();
    }
  }
}

TEST(TurntableMonteCarlo, TrialsScatterAsKVKSays) {
  const Drawable d = MakeDrawable(Model::Residuals::kDepth);
  constexpr int kTrials = 1000;
  const MonteCarloSample sample = MonteCarlo(d.problem, d.fit, d.linear, {}, {.trials = kTrials});
  EXPECT_EQ(sample.failed, 0);
  const Eigen::MatrixXd stated = BudgetOf(d.problem, d.fit.estimate, d.linear).Total();
  const Eigen::MatrixXd centred = sample.estimates.rowwise() - sample.estimates.colwise().mean();
  for (Eigen::Index k = 0; k < stated.rows(); ++k)
    EXPECT_NEAR(std::sqrt(centred.col(k).squaredNorm() / kTrials / stated(k, k)), 1, 4 / std::sqrt(2.0 * kTrials))
        << "system quantity " << k;
}

}  // namespace
}  // namespace scancal::turntable
