#include "solver/uncertainty/monte_carlo.h"
#include <gtest/gtest.h>
#include <cmath>
#include <thread>
#include "solver/uncertainty/budget.h"
#include "solver/uncertainty/covariance.h"
#include "solver/weigh.h"
#include "tests/solver/line_model.h"

namespace scancal {
namespace {

struct FittedProblem {
  Problem problem;
  Fit fit;
  Linearization linear;
};

FittedProblem FitOf(Problem problem) {
  Fit fit = Refine(problem, NominalStart(problem));
  Linearization linear = Linearize(problem, fit.estimate, Storey::kViews);
  return {std::move(problem), std::move(fit), std::move(linear)};
}

MonteCarloSample Sample(const FittedProblem& f, const VarianceDof& dof, const MonteCarloOptions& options) {
  return MonteCarlo(f.problem, f.fit, f.linear, dof, options);
}

Eigen::MatrixXd CovarianceOf(const Eigen::MatrixXd& estimates) {
  const Eigen::MatrixXd centred = estimates.rowwise() - estimates.colwise().mean();
  return centred.transpose() * centred / static_cast<double>(estimates.rows() - 1);
}

// Of an element of a covariance of normal estimates from n trials: var = (v_ij^2 + v_ii v_jj) / n.
void ExpectCovariance(const Eigen::MatrixXd& found, const Eigen::MatrixXd& expected, int64_t trials) {
  for (Eigen::Index i = 0; i < expected.rows(); ++i) {
    for (Eigen::Index j = 0; j < expected.cols(); ++j) {
      const double variance = expected(i, j) * expected(i, j) + expected(i, i) * expected(j, j);
      EXPECT_NEAR(found(i, j), expected(i, j), 4 * std::sqrt(variance / static_cast<double>(trials)))
          << i << ", " << j << "\nfound\n"
          << found << "\nexpected\n"
          << expected;
    }
  }
}

// Slope and curvature, priors on slope and levels, noise of points and of views, whitened view by view.
LineModel WhiteModel(const LineScene& scene) {
  LineModel model;
  model.quantity(LineModel::kCurvature).role = Role::kEstimate;
  model.quantity(LineModel::kSlope).u = 0.05;
  model.quantity(LineModel::kSlope).value = 0.32;
  model.quantity(LineModel::kLevel).u = 0.1;  // about what the data say, whatever they say
  for (const auto& [k, u] : {std::pair{LineModel::kShift, scene.shift}, std::pair{LineModel::kNoise, scene.noise}}) {
    model.quantity(k).role = Role::kConsider;
    model.quantity(k).u = u;
  }
  return model;
}

LineScene Scene() {
  LineScene scene;
  scene.shift = 0.2;
  return scene;
}

void WhitenViews(const LineScene& scene, Problem* problem) {
  for (Target& target : problem->targets) {
    for (Block& view : target.views) {
      if (!view.prior.empty()) continue;
      Eigen::MatrixXd v = Eigen::MatrixXd::Constant(view.size(), view.size(), scene.shift * scene.shift);
      v.diagonal().array() += scene.noise * scene.noise;
      view.mix = Whitening(v);
      view.weight = 1;
    }
  }
}

FittedProblem WhiteFit(const LineScene& scene) {
  Problem problem = MakeProblem<LineModel>(std::make_shared<LineModel>(WhiteModel(scene)), scene.Make());
  WhitenViews(scene, &problem);
  return FitOf(std::move(problem));
}

TEST(MonteCarlo, ScattersAsTheInverseInformationWhereEverythingIsWhitened) {
  const FittedProblem f = WhiteFit(Scene());
  constexpr int64_t kTrials = 5000;
  const MonteCarloSample sample = Sample(f, {}, {.trials = kTrials});
  ASSERT_EQ(sample.estimates.rows(), kTrials);
  EXPECT_EQ(sample.failed, 0);
  const Eigen::MatrixXd expected = InverseInformation(f.linear);
  ExpectCovariance(CovarianceOf(sample.estimates), expected, kTrials);
  const Eigen::VectorXd mean = sample.estimates.colwise().mean();
  for (Eigen::Index k = 0; k < mean.size(); ++k)
    EXPECT_NEAR(mean[k], f.fit.estimate.system[k], 4 * std::sqrt(expected(k, k) / kTrials));
}

TEST(MonteCarlo, ScattersAsKVKWithWhatNoWeightHolds) {
  const LineScene scene = Scene();
  LineModel model = WhiteModel(scene);
  model.quantity(LineModel::kCurvature).role = Role::kConsider;  // one for all: no weight can hold it
  model.quantity(LineModel::kCurvature).u = 0.02;
  Problem problem = MakeProblem<LineModel>(std::make_shared<LineModel>(model), scene.Make());
  WhitenViews(scene, &problem);
  for (Target& target : problem.targets) target.views[0].mix *= 0.5;  // nor must weights be right
  const FittedProblem f = FitOf(std::move(problem));
  constexpr int64_t kTrials = 5000;
  const Eigen::MatrixXd expected = BudgetOf(f.problem, f.fit.estimate, f.linear).Total();
  EXPECT_GT(expected(0, 0), 1.5 * InverseInformation(f.linear)(0, 0));
  ExpectCovariance(CovarianceOf(Sample(f, {}, {.trials = kTrials}).estimates), expected, kTrials);
}

TEST(MonteCarlo, GivesTheSameBitsForAnyThreadsAndBlocks) {
  const FittedProblem f = WhiteFit(Scene());
  const VarianceDof dof = {{"shift", 20}};
  const Eigen::MatrixXd one = Sample(f, dof, {.trials = 200, .seed = 7, .threads = 1}).estimates;
  for (const int threads : {2, 7, 300})
    EXPECT_EQ(Sample(f, dof, {.trials = 200, .seed = 7, .threads = threads}).estimates, one) << threads;
  const Eigen::MatrixXd rest = Sample(f, dof, {.trials = 130, .first = 70, .seed = 7}).estimates;
  EXPECT_EQ(rest, one.bottomRows(130));
  EXPECT_NE(Sample(f, dof, {.trials = 200, .seed = 8}).estimates(0, 0), one(0, 0));
}

TEST(MonteCarlo, TellsHowFarItIs) {
  const FittedProblem f = WhiteFit(Scene());
  double last = -1;
  const auto thread = std::this_thread::get_id();
  Sample(f, {}, {.trials = 500, .threads = 2, .progress = [&](double done) {
                   EXPECT_GE(done, last);
                   EXPECT_LE(done, 1);
                   EXPECT_TRUE(std::this_thread::get_id() == thread);
                   last = done;
                 }});
  EXPECT_GT(last, -1);
}

// Lines whose only uncertainty is the noise of their points.
FittedProblem NoisyLines() {
  LineModel model;
  model.quantity(LineModel::kNoise).role = Role::kConsider;
  model.quantity(LineModel::kNoise).u = 0.1;
  return FitOf(MakeProblem<LineModel>(std::make_shared<LineModel>(model), LineScene().Make()));
}

TEST(MonteCarlo, DrawsEstimatedVariancesFromTheirScaledInverseChiSquared) {
  const FittedProblem f = NoisyLines();
  constexpr int kTrials = 10'000;
  const double u = std::sqrt(BudgetOf(f.problem, f.fit.estimate, f.linear).Total()(0, 0));
  // The slope is then u times a Student t, whose variance is dof / (dof - 2) and whose kurtosis 3 + 6 / (dof - 4).
  const double dof = 12, variance = dof / (dof - 2), kurtosis = 3 + 6 / (dof - 4);
  const Eigen::MatrixXd drawn = Sample(f, {{"noise", dof}}, {.trials = kTrials}).estimates;
  EXPECT_NEAR(CovarianceOf(drawn)(0, 0) / (u * u), variance, 4 * variance * std::sqrt((kurtosis - 1) / kTrials));
  const Eigen::MatrixXd known = Sample(f, {}, {.trials = kTrials}).estimates;
  EXPECT_NEAR(CovarianceOf(known)(0, 0) / (u * u), 1, 4 * std::sqrt(2.0 / kTrials));
  EXPECT_EQ(Sample(f, {{"noise", INFINITY}, {"other", 5}}, {.trials = 100}).estimates, known.topRows(100));
}

TEST(MonteCarlo, TakesEightDegreesOfFreedomForFewer) {
  const FittedProblem f = NoisyLines();
  const Eigen::MatrixXd eight = Sample(f, {{"noise", 8}}, {.trials = 50}).estimates;
  EXPECT_EQ(Sample(f, {{"noise", 1.5}}, {.trials = 50}).estimates, eight);
  EXPECT_NE(Sample(f, {{"noise", 9}}, {.trials = 50}).estimates, eight);
}

// r = y - slope x sqrt(1 + gain), one target, one view: the slope that is found is slope_0 / sqrt(1 + gain).
class GainModel {
 public:
  enum { kSlope, kGain };
  static constexpr int kRowsPerPoint = 1;
  struct View {
    std::vector<double> x;
  };
  struct Target {
    std::string name;
    std::vector<View> views;
  };
  explicit GainModel(double u)
      : quantities_{{"slope", Unit::kOne, Scope::kSystem, Role::kEstimate, 1, 0, false, ""},
                    {"gain", Unit::kOne, Scope::kSystem, Role::kConsider, 0, u, false, ""}} {}
  const Quantities& quantities() const { return quantities_; }
  int Points(const View& view) const { return static_cast<int>(view.x.size()); }
  double Count(const View& view) const { return static_cast<double>(view.x.size()); }
  template <class T>
  void Residual(const Target&, const View& view, const Seen<T>& q, T* r) const {
    using std::sqrt;
    for (size_t i = 0; i < view.x.size(); ++i) r[i] = 2 * view.x[i] - q[kSlope] * (view.x[i] * sqrt(1.0 + q[kGain]));
  }

 private:
  Quantities quantities_;
};

FittedProblem GainFit(double u) {
  return FitOf(MakeProblem<GainModel>(std::make_shared<GainModel>(u), {{"line", {{{1, 2, 3}}}}}));
}

TEST(MonteCarlo, IsSkewedToTheSideOfTheEstimateThatIsCorrectedByADraw) {
  // 2 / sqrt(1 + g) = 2 (1 - g/2 + 3/8 g^2 ...): on average above 2 by 3/4 u^2. Data made by g would average below.
  constexpr int kTrials = 20'000;
  const double u = 0.1;
  const Eigen::MatrixXd estimates = Sample(GainFit(u), {}, {.trials = kTrials}).estimates;
  const double expected = 2 + 0.75 * u * u + 2 * 3 * 35 / 128.0 * std::pow(u, 4);
  EXPECT_NEAR(estimates.mean(), expected, 4 * u / std::sqrt(kTrials));
  EXPECT_GT(estimates.mean(), 2 + 4 * u / std::sqrt(kTrials));
}

TEST(MonteCarlo, CountsAndLeavesOutWhatDoesNotSettle) {
  // Below gain = -1 there is no slope: for u = 0.5 in 2.275 % of the trials.
  constexpr int kTrials = 2000;
  const MonteCarloSample sample = Sample(GainFit(0.5), {}, {.trials = kTrials});
  EXPECT_NEAR(static_cast<double>(sample.failed) / kTrials, 0.02275, 4 * std::sqrt(0.02275 / kTrials));
  EXPECT_EQ(sample.estimates.rows(), kTrials - sample.failed);
  EXPECT_TRUE(sample.estimates.allFinite());
  EXPECT_GT(sample.estimates.minCoeff(), 0);
}

}  // namespace
}  // namespace scancal
