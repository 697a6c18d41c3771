// The published methods on simulated robots, from exact data and from noisy ones.
#include "models/robot_ball/published.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include "models/robot_ball/simulate.h"
#include "models/robot_ball/start.h"
#include "solver/calibration.h"
#include "solver/random.h"

namespace scancal::robot_ball {
namespace {

Scene WithoutNoise(Scene scene) {
  scene.repeatability = scene.ball_noise = scene.u_spheres = 0;
  return scene;
}

// As published, without the errors that no distance can show.
Scene Determined() {
  Scene scene = WithoutNoise({});
  scene.link_errors[0].theta = scene.link_errors[0].d = 0;
  scene.link_errors[5] = {};
  return scene;
}

void ExpectNear(const Kinematics& found, const Kinematics& truth, double mm, double rad) {
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
  const auto [data, truth, stations] = Simulate(Determined());
  for (const auto& method : {Zhou2025, Mu2017}) {
    const Result<Kinematics> found = method(data);
    ASSERT_TRUE(found.ok()) << found.error().message;
    ExpectNear(*found, truth, 1e-6, 1e-9);
    EXPECT_LT(SizeOfErrors(SpacingErrors(data, *found)).max, 1e-7);
  }
  EXPECT_LT(SizeOfErrors(SpacingErrors(data, truth)).max, 1e-9);
  EXPECT_GT(SizeOfErrors(SpacingErrors(data, {truth.flange_from_scanner, {}})).max, 0.1);
}

TEST(Zhou2025, WhatIsAbsorbedElsewhereDoesNotShowInDistances) {
  Scene scene = WithoutNoise({});  // theta_1, d_1 and the last link as well
  scene.link_errors[1].d = 0.3;    // as much of d_3
  const auto [data, truth, stations] = Simulate(scene);
  const Result<Kinematics> found = Zhou2025(data);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_LT(SizeOfErrors(SpacingErrors(data, *found)).max, 1e-6);
  EXPECT_EQ(found->link_errors[0].theta, 0);
  EXPECT_EQ(found->link_errors[5].d, 0);
}

TEST(Zhou2025, PosesOfTheControllerLeaveOnlyTheHandEye) {
  Scene scene = WithoutNoise({});
  scene.link_errors.assign(6, {});
  Measurements data = Simulate(scene).data;
  for (Station& station : data.stations)
    for (Model::View& view : station.views) {
      view.base_from_flange = BaseFromFlange(data.links, view.joints);
      view.joints.clear();
    }
  data.links.clear();
  const Result<Kinematics> found = Zhou2025(data);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_TRUE(found->link_errors.empty());
  EXPECT_TRUE(found->flange_from_scanner.isApprox(PublishedHandEye(), 1e-9));
}

TEST(Zhou2025, TheOrderOfStationsPosesAndBallsDoesNotMatter) {
  const Measurements data = Simulate({}).data;
  Measurements turned = data;
  std::ranges::reverse(turned.stations);
  for (Station& station : turned.stations) {
    std::ranges::reverse(station.views);
    for (Model::View& view : station.views) std::ranges::reverse(view.balls);
  }
  const Result<Kinematics> one = Zhou2025(data), other = Zhou2025(turned);
  ASSERT_TRUE(one.ok() && other.ok());
  ExpectNear(*one, *other, 1e-5, 1e-8);
}

TEST(Zhou2025, SaysThatThereAreTooFewDistances) {
  Scene scene;
  scene.stations = 1;
  scene.poses = 3;
  scene.translations = 0;
  const Simulated robot = Simulate(scene);  // the second pose sees other balls
  const auto found = IdentifyByDistances(robot.data, robot.truth, Identified::kHandEyeAndLinks);
  EXPECT_TRUE(found.ok()) << found.error().message;
  Measurements fewer = robot.data;
  fewer.stations[0].views.pop_back();
  const auto of_two = IdentifyByDistances(fewer, robot.truth, Identified::kHandEyeAndLinks);
  ASSERT_FALSE(of_two.ok());
  EXPECT_THAT(of_two.error().message, testing::HasSubstr("16 distances for 24 unknowns"));
}

TEST(Ren2012, RecoversTheHandEyeFromOneSphere) {
  Scene scene = WithoutNoise({});
  scene.link_errors.assign(6, {});
  Measurements data = Simulate(scene).data;
  for (Model::Sphere& sphere : data.spheres) sphere.centre *= 3;  // the artifact does not matter
  const Result<Kinematics> found = Ren2012(data);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_TRUE(found->flange_from_scanner.isApprox(PublishedHandEye(), 1e-9));
  EXPECT_EQ(found->link_errors.size(), 6u);
}

TEST(Ren2012, IsTheLeastSquaresOfTheSpheresScatter) {
  Scene scene;
  scene.stations = 1;
  scene.poses = 12;
  scene.field = 1e6;
  Measurements data = Simulate(scene).data;
  for (Model::View& view : data.stations[0].views) view.balls.resize(1);
  const Result<Kinematics> found = Ren2012(data);
  ASSERT_TRUE(found.ok()) << found.error().message;
  const auto scatter = [&](const Eigen::Isometry3d& flange_from_scanner) {
    Eigen::Matrix3Xd p(3, std::ssize(data.stations[0].views));
    for (int j = 0; j < p.cols(); ++j) {
      const Model::View& view = data.stations[0].views[j];
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
  auto [data, truth, stations] = Simulate(WithoutNoise({}));
  data.check.resize(2);
  data.check[0].distance += 0.5;
  data.check[1].distance -= 0.1;
  const std::vector<double> errors = SpacingErrors(data, truth);
  EXPECT_THAT(errors, testing::Pointwise(testing::DoubleNear(1e-9), {-0.5, 0.1}));
  EXPECT_NEAR(SizeOfErrors(errors).max, 0.5, 1e-9);
  EXPECT_NEAR(SizeOfErrors(errors).mean, 0.3, 1e-9);
}

// Mean error of the spacing over some simulated calibrations; the check itself without noise.
template <class Spoil>
double MeanSpacing(Result<Kinematics> (*method)(const Measurements&), const Spoil& spoil) {
  constexpr int kSeeds = 8;
  double mean = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    Scene scene;
    scene.seed = scene.noise_seed = seed;
    Measurements data = Simulate(scene).data;
    spoil(&data);
    data.check = Simulate(WithoutNoise(scene)).data.check;
    const Result<Kinematics> found = method(data);
    EXPECT_TRUE(found.ok()) << found.error().message;
    mean += found.ok() ? SizeOfErrors(SpacingErrors(data, *found)).mean / kSeeds : NAN;
  }
  return mean;
}

TEST(PublishedMethods, TheLinksMatterMoreThanTheCentres) {
  const auto as_it_is = [](Measurements*) {};
  const double ren = MeanSpacing(Ren2012, as_it_is), nominal = MeanSpacing(InitialHandEye, as_it_is);
  const double mu = MeanSpacing(Mu2017, as_it_is), zhou = MeanSpacing(Zhou2025, as_it_is);
  EXPECT_GT(nominal, 5 * mu);
  EXPECT_GT(ren, 5 * mu);
  EXPECT_NEAR(zhou, mu, 0.05 * mu);  // of equal noise, the correction takes nothing that many distances had left
}

TEST(PublishedMethods, CorrectedCentresAreBetterIfSomeBallsAreWorse) {
  const auto one_ball_is_worse = [](Measurements* data) {
    constexpr double kWorse = 20;
    Random random(3, 0);
    for (Station& station : data->stations)
      for (Model::View& view : station.views)
        for (Model::SeenBall& ball : view.balls)
          if (ball.sphere == 3) {
            for (double& x : ball.centre) x += 0.035 * kWorse * random.Normal();
            ball.spread *= kWorse;
          }
  };
  EXPECT_LT(MeanSpacing(Zhou2025, one_ball_is_worse), 0.8 * MeanSpacing(Mu2017, one_ball_is_worse));
}

}  // namespace
}  // namespace scancal::robot_ball
