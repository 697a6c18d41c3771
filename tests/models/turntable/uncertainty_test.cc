// The uncertainties of the turntable against simulated repetitions, and the bias that the depth residual does not have.
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include "io/units.h"
#include "models/turntable/scanner.h"
#include "solver/uncertainty/covariance.h"
#include "solver/uncertainty/jackknife.h"
#include "tests/models/turntable/scene.h"

namespace scancal::turntable {
namespace {

struct Study {
  Eigen::Vector2d mean = {0, 0}, scatter = {0, 0};  // of the errors of M, N, mm
  Eigen::Vector2d naive = {0, 0}, clustered = {0, 0}, jackknife = {0, 0}, expected_jackknife = {0, 0};  // rms of u
  double lack_of_fit = 0;                                                                               // mean F
  int warned_of_jackknife = 0;                                                                          // trials
};

Study Repeat(Scene scene, Model::Residuals residuals, int trials) {
  Study study;
  for (int trial = 0; trial < trials; ++trial) {
    scene.seed = static_cast<uint64_t>(trial) + 1;
    Problem problem = MakeProblemOf(scene, {residuals, true, false, 0}, Model(residuals));
    problem.WeighEqually(scene.noise_y);
    const Solution solution = Solve(problem, StartNear(problem, scene.system));
    EXPECT_TRUE(solution.fit.converged);
    const Eigen::Vector2d error = solution.fit.estimate.system - Eigen::Vector2d(scene.system.M(), scene.system.N());
    study.mean += error / trials;
    study.scatter += error.cwiseAbs2() / trials;
    study.naive += NaiveCovariance(problem, solution.linear).matrix.diagonal() / trials;
    study.clustered += ClusteredCovariance(problem, solution.linear).matrix.diagonal() / trials;
    study.jackknife += LeaveOneTargetOut(problem, solution.fit, solution.linear).covariance.diagonal() / trials;
    study.expected_jackknife +=
        ExpectLeaveOneTargetOut(problem, solution.fit.estimate, solution.linear).variance / trials;
    PureError pure;
    for (const SimulatedPlacement& placement : Simulate(scene)) {
      for (const Profile& profile : Compress(placement)) {
        pure.sum_of_squares += profile.pure_error.sum_of_squares;
        pure.dof += profile.pure_error.dof;
      }
    }
    const Calibration result = Summarize(solution, pure);
    study.lack_of_fit += result.lack_of_fit.F / trials;
    study.warned_of_jackknife += std::any_of(result.warnings.begin(), result.warnings.end(), [](const auto& warning) {
      return warning.english.find("leaving one target out") != std::string::npos;
    });
  }
  for (Eigen::Vector2d* variance :
       {&study.scatter, &study.naive, &study.clustered, &study.jackknife, &study.expected_jackknife})
    *variance = variance->cwiseSqrt();
  return study;
}

Scene LongScene() {
  Scene scene;
  scene.profiles = 60;
  scene.points = 20;
  return scene;
}

constexpr int kTrials = 400;
const double kOfScatter = 4 / std::sqrt(2.0 * kTrials);  // four standard deviations of a ratio of standard deviations

TEST(TurntableUncertainty, NaiveAndClusteredAreRightOnWhiteNoise) {
  const Study study = Repeat(LongScene(), Model::Residuals::kDepth, kTrials);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(study.naive[k] / study.scatter[k], 1, kOfScatter);
    EXPECT_NEAR(study.clustered[k] / study.scatter[k], 1, kOfScatter);
    EXPECT_NEAR(study.jackknife[k] / study.expected_jackknife[k], 1, 0.15);
  }
  EXPECT_LE(study.warned_of_jackknife, 5);  // 0.8 expected: two parameters, each once in a thousand
  EXPECT_NEAR(study.lack_of_fit, 1, 4 * std::sqrt(2 / 350.0 / kTrials));
}

TEST(TurntableUncertainty, OnlyTheClusteredOneIsRightUnderEncoderJitter) {
  Scene scene = LongScene();
  scene.encoder_jitter = 1e-4;  // 20 arcsec
  const Study study = Repeat(scene, Model::Residuals::kDepth, kTrials);
  EXPECT_LT(study.naive[0] / study.scatter[0], 0.7);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(study.clustered[k] / study.scatter[k], 1, kOfScatter);
    EXPECT_NEAR(study.jackknife[k] / study.expected_jackknife[k], 1, 0.15);
  }
  EXPECT_LE(study.warned_of_jackknife, 5);
  EXPECT_GT(study.lack_of_fit, 1.5);
}

TEST(TurntableUncertainty, TheJackknifeWarnsWhenPlacementsDisagree) {
  const Scene scene = LongScene();
  auto placements = Simulate(scene);
  for (SimulatedProfile& profile : placements[1].profiles) profile.alpha += 2e-3;  // the mount slipped in between
  for (SimulatedProfile& profile : placements[1].profiles)
    for (size_t i = 0; i < profile.y.size(); ++i) profile.y[i] *= 1 + 2e-3;
  Problem problem =
      MakeProblem<Model>(std::make_shared<const Model>(Model::Residuals::kDepth), MakeTargets(placements, {}));
  problem.WeighEqually(scene.noise_y);
  const Estimate start = StartNear(problem, scene.system);
  const Calibration result = Summarize(Solve(std::move(problem), start), {});
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_NE(result.warnings[0].english.find("N: leaving one target out"), std::string::npos) << result.warnings[0];
}

TEST(TurntableUncertainty, PlainPointToPlaneIsBiasedAndTheDepthResidualIsNot) {
  Scene scene = LongScene();
  scene.noise_y = 0.2;
  const Study plain = Repeat(scene, Model::Residuals::kPlane, kTrials);
  const Study depth = Repeat(scene, Model::Residuals::kDepth, kTrials);
  const double standard_error = plain.scatter[1] / std::sqrt(kTrials);
  EXPECT_LT(plain.mean[1], -4 * standard_error);  // about -0.07 mm, see docs/turntable.md, section 2
  EXPECT_GT(plain.mean[1], -0.3);
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(depth.mean[k], 0, 4 * depth.scatter[k] / std::sqrt(kTrials));
}

TEST(TurntableUncertainty, IsInRadiansForTilts) {  // Ceres 2.1's own manifolds would be off by two
  Scene scene = LongScene();
  scene.sweep = 60 * kDegree;
  Model model(Model::Residuals::kDepth);
  model.quantity(Model::kTiltX).role = model.quantity(Model::kTiltY).role = Role::kEstimate;
  Eigen::Vector2d scatter = {0, 0}, stated = {0, 0};
  for (int trial = 0; trial < kTrials; ++trial) {
    scene.seed = static_cast<uint64_t>(trial) + 1;
    const Problem problem = MakeProblemOf(scene, {}, model);
    const Solution solution = Solve(problem, StartNear(problem, scene.system));
    scatter += solution.fit.estimate.system.tail<2>().cwiseAbs2() / kTrials;
    stated += NaiveCovariance(problem, solution.linear).matrix.diagonal().tail<2>() / kTrials;
  }
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(std::sqrt(stated[k] / scatter[k]), 1, kOfScatter);
}

TEST(Turntable, TurnsANormalByHonestRadians) {
  Model::Target target;
  Model::SetPlane({0.1, -0.97, 0.2}, 500, &target);
  for (const double angle : {1e-9, 0.01, 1.0}) {
    const auto [normal, distance] = Model::Plane(target, {0.6 * angle, 0.8 * angle, 0.25});
    EXPECT_NEAR(std::atan2(normal.cross(target.normal).norm(), normal.dot(target.normal)), angle,
                1e-12 * angle + 1e-15);
    EXPECT_NEAR(normal.norm(), 1, 1e-14);
    EXPECT_EQ(distance, 500.25);
  }
}

TEST(Turntable, MirroredSenseFitsWithMinusM) {  // wrong sense of rotation leaves no trace but the sign of M
  const Scene scene = LongScene();
  auto placements = Simulate(scene);
  for (SimulatedPlacement& placement : placements) {
    placement.normal.x() = -placement.normal.x();
    for (SimulatedProfile& profile : placement.profiles) profile.alpha = -profile.alpha;
  }
  const Problem mirrored =
      MakeProblem<Model>(std::make_shared<const Model>(Model::Residuals::kDepth), MakeTargets(placements, {}));
  const Problem right = MakeProblemOf(scene, {}, Model(Model::Residuals::kDepth));
  System opposite = scene.system;
  opposite[Model::kM] = -opposite.M();
  const Fit a = Refine(right, StartNear(right, scene.system)), b = Refine(mirrored, StartNear(mirrored, opposite));
  EXPECT_NEAR(a.estimate.system[0], -b.estimate.system[0], 1e-9);
  EXPECT_NEAR(a.estimate.system[1], b.estimate.system[1], 1e-9);
  EXPECT_NEAR(a.cost, b.cost, 1e-9 * a.cost);
}

TEST(Turntable, OnePointAProfileIsEnough) {
  Scene scene = LongScene();
  scene.profiles = 300;
  scene.points = 1;
  scene.noise_y = 0;
  auto placements = Simulate(scene);
  for (SimulatedPlacement& placement : placements) {
    // Points at changing heights: simulate() puts a single one at z = 0, where the plane's lean would not show.
    for (size_t k = 0; k < placement.profiles.size(); ++k) {
      SimulatedProfile& profile = placement.profiles[k];
      const double z = 40 * std::sin(1.7 * static_cast<double>(k));
      const Eigen::Vector3d origin = scene.system.Point(profile.alpha, 0, z),
                            along = scene.system.Point(profile.alpha, 1, z) - origin;
      profile.z = {z};
      profile.y = {(placement.distance - placement.normal.dot(origin)) / placement.normal.dot(along)};
    }
  }
  const Problem problem =
      MakeProblem<Model>(std::make_shared<const Model>(Model::Residuals::kDepth), MakeTargets(placements, {}));
  const Fit fit = Refine(problem, StartNear(problem, scene.system));
  EXPECT_TRUE(fit.converged) << fit.message;
  EXPECT_NEAR(fit.estimate.system[0], scene.system.M(), 1e-9);
  EXPECT_NEAR(fit.estimate.system[1], scene.system.N(), 1e-9);
}

TEST(Turntable, NodesGiveTheSameCostAsAllProfiles) {
  const Scene scene = LongScene();
  const Problem problem =
      MakeProblemOf(scene, {Model::Residuals::kPlane, true, false, 0}, Model(Model::Residuals::kPlane));
  ASSERT_TRUE(problem.NodesSuffice());
  const Estimate start = StartNear(problem, scene.system);
  const Linearization views = Linearize(problem, start, Storey::kViews),
                      nodes = Linearize(problem, start, Storey::kNodes);
  EXPECT_NEAR(nodes.cost, views.cost, 1e-11 * views.cost);
  EXPECT_LT((InverseInformation(nodes) - InverseInformation(views)).norm(), 1e-9 * InverseInformation(views).norm());
  EXPECT_FALSE(MakeProblemOf(scene, {}, Model(Model::Residuals::kDepth)).NodesSuffice());
}

// Little noise: one step on the triangles; much of it: the fit is repeated.
TEST(TurntableUncertainty, WithoutAPlacementAsTheFullFitSays) {
  for (const double noise : {0.05, 5.0}) {
    Scene scene = LongScene();
    scene.noise_y = noise;
    const Model::Residuals depth = Model::Residuals::kDepth;
    Problem problem = MakeProblemOf(scene, {depth, true, false, 0}, Model(depth));
    problem.WeighEqually(noise);
    const Solution solution = Solve(problem, StartNear(problem, scene.system));
    const Jackknife jackknife = LeaveOneTargetOut(problem, solution.fit, solution.linear);
    ASSERT_EQ(jackknife.estimates.rows(), 3);
    EXPECT_TRUE(jackknife.converged);
    for (std::ptrdiff_t t = 0; t < 3; ++t) {
      Problem rest = problem;
      Estimate start = solution.fit.estimate;
      rest.targets.erase(rest.targets.begin() + t);
      start.targets.erase(start.targets.begin() + t);
      const Fit without = Refine(rest, start);
      for (Eigen::Index k = 0; k < 2; ++k)
        EXPECT_NEAR(jackknife.estimates(t, k), without.estimate.system[k],
                    0.01 * std::sqrt(solution.naive.matrix(k, k)))
            << noise;
    }
  }
}

}  // namespace
}  // namespace scancal::turntable
