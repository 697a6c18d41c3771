#include "solver/refine.h"
#include <gtest/gtest.h>
#include "solver/linearize.h"
#include "solver/uncertainty/jackknife.h"
#include "tests/solver/line_model.h"

namespace scancal {
namespace {

Problem Pose(const LineScene& scene, const LineModel& model = {}) {
  return MakeProblem<LineModel>(std::make_shared<LineModel>(model), scene.Make());
}

TEST(Refine, RecoversTheTruthFromNoiselessData) {
  LineScene scene;
  scene.noise = 0;
  const Problem problem = Pose(scene);
  const Fit fit = Refine(problem, NominalStart(problem));
  EXPECT_TRUE(fit.converged) << fit.message;
  EXPECT_NEAR(fit.estimate.system[0], 0.3, 1e-13);
  EXPECT_NEAR(fit.estimate.targets[2][0], 20, 1e-12);
  EXPECT_LT(fit.cost, 1e-24);
}

TEST(Refine, CombinesDataAndPriorByTheirUncertainties) {
  LineModel model;
  model.quantity(LineModel::kSlope).value = 1;
  model.quantity(LineModel::kSlope).u = 0.02;
  LineScene scene;
  Problem without = Pose(scene), with = Pose(scene, model);
  without.WeighEqually(scene.noise);
  with.WeighEqually(scene.noise);
  const Fit alone = Refine(without, NominalStart(without)), both = Refine(with, NominalStart(with));
  const double weight = std::pow(Linearize(without, alone.estimate, Storey::kViews).factor(0, 0), 2);
  const double prior_weight = 1 / (0.02 * 0.02);
  EXPECT_NEAR(both.estimate.system[0], (weight * alone.estimate.system[0] + prior_weight * 1) / (weight + prior_weight),
              1e-12);
}

TEST(Refine, TellsThatItDidNotConverge) {
  const Problem problem = Pose({});
  Estimate nowhere = NominalStart(problem);
  nowhere.system[0] = std::numeric_limits<double>::quiet_NaN();
  const Fit fit = Refine(problem, nowhere);
  EXPECT_FALSE(fit.converged);
  EXPECT_FALSE(fit.message.empty());
}

TEST(Refine, DoesNotDependOnTheOrderOfTargetsAndViews) {
  const Problem problem = Pose({});
  Problem turned = problem;
  std::reverse(turned.targets.begin(), turned.targets.end());
  for (Target& target : turned.targets) std::reverse(target.views.begin(), target.views.end());
  EXPECT_NEAR(Refine(problem, NominalStart(problem)).estimate.system[0],
              Refine(turned, NominalStart(turned)).estimate.system[0], 1e-14);
}

TEST(Refine, GivesTheSameBitsEveryTime) {
  const Problem problem = Pose({});
  const Fit first = Refine(problem, NominalStart(problem));
  for (int k = 1; k < 10; ++k) {
    const std::vector<double> elsewhere(1000 * k);  // moves the heap
    const Problem again = Pose({});
    const Fit fit = Refine(again, NominalStart(again));
    EXPECT_EQ(fit.estimate.system, first.estimate.system);
    EXPECT_EQ(fit.cost, first.cost);
  }
}

// y = a exp(-b x) at scattered points: residuals so large that Gauss-Newton gains a fifth of a digit a step.
class DecayModel {
 public:
  enum { kAmplitude, kRate };
  static constexpr int kRowsPerPoint = 1;
  struct View {
    double x, y;
  };
  struct Target {
    std::string name = "decay";
    std::vector<View> views;
  };
  explicit DecayModel(double rate)
      : quantities_{{"amplitude", Unit::kOne, Scope::kSystem, Role::kEstimate, 3, 0, false, ""},
                    {"rate", Unit::kOne, Scope::kSystem, Role::kEstimate, rate, 0, false, ""}} {}
  const Quantities& quantities() const { return quantities_; }
  int Points(const View&) const { return 1; }
  double Count(const View&) const { return 1; }
  template <class T>
  void Residual(const Target&, const View& view, const Seen<T>& q, T* r) const {
    using std::exp;
    r[0] = q[kAmplitude] * exp(-q[kRate] * view.x) - view.y;
  }

 private:
  Quantities quantities_;
};

TEST(Refine, GoesOnUntilNothingIsLeftToGainWhateverTheUnit) {
  double rate_of_one = 0;
  for (const double unit : {1.0, 1e9}) {
    DecayModel::Target target;
    const double y[] = {3, 2, 0, 0, -1, 0};
    for (int i = 0; i < 6; ++i) target.views.push_back({i * unit, y[i]});
    const Problem problem = MakeProblem<DecayModel>(std::make_shared<DecayModel>(0.8 / unit), {target});
    const Fit fit = Refine(problem, NominalStart(problem));
    EXPECT_TRUE(fit.converged) << fit.message;
    const Linearization there = Linearize(problem, fit.estimate, Storey::kViews);
    EXPECT_GT(std::sqrt(there.cost / 6), 0.3);
    EXPECT_LT(StepLength(there), 1e-9 * std::sqrt(there.cost / 6));
    if (unit == 1) rate_of_one = fit.estimate.system[1];
    EXPECT_NEAR(fit.estimate.system[1] * unit / rate_of_one, 1, 1e-9);
  }
}

TEST(Observability, NamesWhatHasNoEffectOfItsOwn) {
  LineModel model;
  model.quantity(LineModel::kCurvature).role = Role::kEstimate;
  LineScene scene;
  scene.views = 1;
  scene.points = 1;  // one point a line: its level absorbs everything
  const Problem problem = Pose(scene, model);
  const Observability seen = Observe(problem, Linearize(problem, NominalStart(problem), Storey::kViews));
  EXPECT_EQ(seen.undetermined, (std::vector<std::string>{"slope", "curvature"}));
  EXPECT_TRUE(seen.undetermined_targets.empty());

  scene.views = 8;
  const Problem determined = Pose(scene, model);
  EXPECT_TRUE(
      Observe(determined, Linearize(determined, NominalStart(determined), Storey::kViews)).undetermined.empty());
}

Jackknife JackknifeOf(const Problem& problem) {
  const Fit fit = Refine(problem, NominalStart(problem));
  return LeaveOneTargetOut(problem, fit, Linearize(problem, fit.estimate, Storey::kViews));
}

TEST(Jackknife, IsTheSpreadOfTheFitsWithoutOneTarget) {
  const Problem problem = Pose({});
  const Jackknife jackknife = JackknifeOf(problem);
  ASSERT_EQ(jackknife.estimates.rows(), 3);
  LineScene scene;
  auto targets = scene.Make();
  targets.erase(targets.begin() + 1);
  const Problem rest = MakeProblem<LineModel>(std::make_shared<LineModel>(), targets);
  EXPECT_NEAR(jackknife.estimates(1, 0), Refine(rest, NominalStart(rest)).estimate.system[0], 1e-13);
  double mean = jackknife.estimates.col(0).mean(), sum = 0;
  for (int t = 0; t < 3; ++t) sum += std::pow(jackknife.estimates(t, 0) - mean, 2);
  EXPECT_NEAR(jackknife.covariance(0, 0), sum * 2 / 3, 1e-15);
}

TEST(Jackknife, NeedsTwoTargets) {
  LineScene scene;
  scene.targets = 1;
  const Problem problem = Pose(scene);
  EXPECT_EQ(JackknifeOf(problem).estimates.rows(), 0);
}

}  // namespace
}  // namespace scancal
