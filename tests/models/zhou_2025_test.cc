// The published methods on simulated robots, from exact data and from noisy ones.
#include "models/robot_ball/zhou_2025.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include "models/robot_ball/centre_adjustment.h"
#include "models/robot_ball/distance_identification.h"
#include "models/robot_ball/mu_2017.h"
#include "models/robot_ball/ren_2012.h"
#include "models/robot_ball/spacing.h"
#include "tests/models/robot_scene.h"

namespace scancal {
namespace {

RobotData SimulateWithCheck(const RobotScene& scene) {
  RobotData data = Simulate(scene);
  AddCheck(scene, &data);
  return data;
}

RobotScene PublishedScene(uint64_t seed) {
  RobotScene scene;
  scene.errors = ArmErrors();
  scene.balls = 4;
  scene.noise = 0.035;
  scene.repeatability = 0.04;
  scene.seed = seed;
  return scene;
}

void ExpectNear(const RobotSetup& found, const RobotSetup& truth, double mm, double rad) {
  const Eigen::Matrix<double, 6, 1> off = NumbersOf(found.flange_from_scanner) - NumbersOf(truth.flange_from_scanner);
  EXPECT_LT(off.head<3>().norm(), mm);
  EXPECT_LT(off.tail<3>().norm(), rad);
  ASSERT_EQ(found.link_errors.size(), truth.link_errors.size());
  for (size_t k = 0; k < truth.link_errors.size(); ++k) {
    const Link &is = found.link_errors[k], &should = truth.link_errors[k];
    EXPECT_NEAR(is.theta, should.theta, rad) << k + 1;
    EXPECT_NEAR(is.d, should.d, mm) << k + 1;
    EXPECT_NEAR(is.a, should.a, mm) << k + 1;
    EXPECT_NEAR(is.alpha, should.alpha, rad) << k + 1;
    EXPECT_NEAR(is.beta, should.beta, rad) << k + 1;
  }
}

TEST(Zhou2025, RecoversHandEyeAndLinksFromNoiselessData) {
  RobotScene scene = PublishedScene(1);
  scene.noise = scene.repeatability = 0;
  const RobotData data = SimulateWithCheck(scene);
  for (const auto& method : {Zhou2025, Mu2017}) {
    const Result<RobotSetup> found = method(data);
    ASSERT_TRUE(found.ok()) << found.error().message;
    ExpectNear(*found, Truth(scene), 1e-6, 1e-9);
    EXPECT_LT(SpacingErrors(data, *found).max, 1e-7);
  }
  EXPECT_LT(SpacingErrors(data, Truth(scene)).max, 1e-9);
  EXPECT_GT(SpacingErrors(data, {scene.flange_from_scanner, {}}).max, 0.1);
}

TEST(Zhou2025, WhatIsAbsorbedElsewhereDoesNotShowInDistances) {
  RobotScene scene = PublishedScene(2);
  scene.noise = scene.repeatability = 0;
  scene.errors[0].theta = 4e-4;  // the base's
  scene.errors[0].d = 0.45;
  scene.errors[1].d = 0.3;                        // as much of d_3
  scene.errors[5] = {-4e-4, 0.1, 0.04, 5e-4, 0};  // the hand-eye's
  const RobotData data = SimulateWithCheck(scene);
  const Result<RobotSetup> found = Zhou2025(data);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_LT(SpacingErrors(data, *found).max, 1e-7);
  EXPECT_NEAR(found->link_errors[2].d, scene.errors[1].d + scene.errors[2].d, 1e-5);
  EXPECT_EQ(found->link_errors[0].theta, 0);
  EXPECT_EQ(found->link_errors[5].d, 0);
}

TEST(Zhou2025, PosesOfTheControllerLeaveOnlyTheHandEye) {
  RobotScene scene = PublishedScene(3);
  scene.errors = std::vector<Link>(6);
  scene.noise = scene.repeatability = 0;
  RobotData data = Simulate(scene);
  for (Station& station : data.stations)
    for (RobotBall::View& view : station.views) {
      view.base_from_flange = BaseFromFlange(data.links, view.joints);
      view.joints.clear();
    }
  data.links.clear();
  const Result<RobotSetup> found = Zhou2025(data);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_TRUE(found->link_errors.empty());
  EXPECT_TRUE(found->flange_from_scanner.isApprox(scene.flange_from_scanner, 1e-9));
}

TEST(Zhou2025, TheOrderOfStationsPosesAndBallsDoesNotMatter) {
  const RobotData data = Simulate(PublishedScene(4));
  RobotData turned = data;
  std::ranges::reverse(turned.stations);
  for (Station& station : turned.stations) {
    std::ranges::reverse(station.views);
    for (RobotBall::View& view : station.views) std::ranges::reverse(view.balls);
  }
  const Result<RobotSetup> one = Zhou2025(data), other = Zhou2025(turned);
  ASSERT_TRUE(one.ok() && other.ok());
  ExpectNear(*one, *other, 1e-5, 1e-8);
}

TEST(Zhou2025, SaysThatThereAreTooFewDistances) {
  RobotScene scene = PublishedScene(5);
  scene.stations = 1;
  scene.poses = 3;
  scene.balls = 3;
  RobotData data = Simulate(scene);
  data.stations[0].views.pop_back();
  const auto found = IdentifyByDistances(data, Truth(scene), Identified::kHandEyeAndLinks);
  ASSERT_FALSE(found.ok());
  EXPECT_THAT(found.error().message, testing::HasSubstr("9 distances for 24 unknowns"));
}

TEST(Ren2012, RecoversTheHandEyeFromOneSphere) {
  RobotScene scene;
  scene.poses = 12;
  RobotData data = Simulate(scene);
  for (RobotBall::Sphere& sphere : data.spheres) sphere.centre *= 3;  // the artifact does not matter
  const Result<RobotSetup> found = Ren2012(data);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_TRUE(found->flange_from_scanner.isApprox(scene.flange_from_scanner, 1e-9));
  EXPECT_EQ(found->link_errors.size(), 6u);
}

TEST(Ren2012, IsTheLeastSquaresOfTheSpheresScatter) {
  RobotScene scene = PublishedScene(6);
  scene.stations = 1;
  scene.poses = 12;
  RobotData data = Simulate(scene);
  Random random(9, 0);
  for (RobotBall::View& view : data.stations[0].views)
    view.balls = {{0, SeenPoint(data, scene, view, {600, 100, 300}, random)}};
  const Result<RobotSetup> found = Ren2012(data);
  ASSERT_TRUE(found.ok()) << found.error().message;
  const auto scatter = [&](const Eigen::Isometry3d& flange_from_scanner) {
    Eigen::Matrix3Xd p(3, 12);
    for (int j = 0; j < 12; ++j) {
      const RobotBall::View& view = data.stations[0].views[j];
      p.col(j) = BaseFromScanner(data, {flange_from_scanner, {}}, view) * view.balls[0].centre;
    }
    return (p.colwise() - p.rowwise().mean()).squaredNorm();
  };
  const Eigen::Matrix<double, 6, 1> best = NumbersOf(found->flange_from_scanner);
  for (int k = 0; k < 6; ++k)
    for (const double step : {-1e-3, 1e-3}) {
      Eigen::Matrix<double, 6, 1> beside = best;
      beside[k] += step;
      EXPECT_GT(scatter(PoseOf(beside)), scatter(PoseOf(best))) << k;
    }
}

TEST(SpacingErrors, AreSigned) {
  RobotScene scene;
  RobotData data = SimulateWithCheck(scene);
  data.check.resize(2);
  data.check[0].distance += 0.5;
  data.check[1].distance -= 0.1;
  const Spacing spacing = SpacingErrors(data, Truth(scene));
  EXPECT_THAT(spacing.errors, testing::Pointwise(testing::DoubleNear(1e-9), {-0.5, 0.1}));
  EXPECT_NEAR(spacing.max, 0.5, 1e-9);
  EXPECT_NEAR(spacing.mean, 0.3, 1e-9);
}

// Mean error of the spacing over some simulated calibrations; the check itself without noise.
template <class Spoil>
double MeanSpacing(Result<RobotSetup> (*method)(const RobotData&), const Spoil& spoil) {
  constexpr int kSeeds = 8;
  double mean = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    RobotScene scene = PublishedScene(seed);
    RobotData data = Simulate(scene);
    spoil(&data);
    scene.noise = scene.repeatability = 0;
    AddCheck(scene, &data);
    const Result<RobotSetup> found = method(data);
    EXPECT_TRUE(found.ok()) << found.error().message;
    mean += found.ok() ? SpacingErrors(data, *found).mean / kSeeds : NAN;
  }
  return mean;
}

TEST(PublishedMethods, TheLinksMatterMoreThanTheCentres) {
  const auto as_it_is = [](RobotData*) {};
  const double ren = MeanSpacing(Ren2012, as_it_is), nominal = MeanSpacing(InitialHandEye, as_it_is);
  const double mu = MeanSpacing(Mu2017, as_it_is), zhou = MeanSpacing(Zhou2025, as_it_is);
  EXPECT_GT(ren, 1.2 * nominal);  // one sphere at one station, against all balls at all
  EXPECT_GT(nominal, 5 * mu);
  EXPECT_NEAR(zhou, mu, 0.05 * mu);  // of equal noise, the correction takes nothing that many distances had left
}

TEST(PublishedMethods, CorrectedCentresAreBetterIfSomeBallsAreWorse) {
  const auto one_ball_is_worse = [](RobotData* data) {
    constexpr double kWorse = 20;
    Random random(3, 0);
    for (Station& station : data->stations)
      for (RobotBall::View& view : station.views)
        for (RobotBall::SeenBall& ball : view.balls)
          if (ball.sphere == 3) {
            ball.centre += NormalVector(0.035 * kWorse, random);
            ball.spread *= kWorse;
          }
  };
  EXPECT_LT(MeanSpacing(Zhou2025, one_ball_is_worse), 0.8 * MeanSpacing(Mu2017, one_ball_is_worse));
}

}  // namespace
}  // namespace scancal
