#include "models/sphere.h"
#include <gmock/gmock.h>
#include <Eigen/Dense>
#include <numbers>
#include <vector>
#include "solver/random.h"

namespace scancal {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

const Eigen::Vector3d kCapCentre(512, -230, 1480);
constexpr double kCapRadius = 6.35;

// n points within half_angle of the direction -Z as seen from the centre, noise across the surface.
std::vector<Eigen::Vector3d> Cap(int n, double half_angle, double noise, uint64_t seed = 1) {
  Random random(seed, 0);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < n; ++i) {
    const double c = 1 - random.Uniform() * (1 - std::cos(half_angle)), s = std::sqrt(1 - c * c);
    const double phi = 2 * std::numbers::pi * random.Uniform();
    points.push_back(kCapCentre + (kCapRadius + noise * random.Normal()) *
                                      Eigen::Vector3d(s * std::cos(phi), s * std::sin(phi), -c));
  }
  return points;
}

SphereChoice Known(double radius, double u = 0) { return {KnownRadius{radius, u}, {}}; }

TEST(Sphere, RecoversTheTruthFromExactPoints) {
  for (const double half_angle : {0.2, 1.0, std::numbers::pi}) {
    const auto points = Cap(30, half_angle, 0);
    for (const SphereChoice& choice : {SphereChoice{}, Known(kCapRadius)}) {
      const SphereFit fit = FitSphere(points, choice);
      EXPECT_THAT(fit.doubt, IsEmpty());
      EXPECT_LT((fit.centre - kCapCentre).norm(), 1e-9) << half_angle;
      EXPECT_NEAR(fit.radius, kCapRadius, 1e-9);
    }
  }
}

// Statistical: standard deviations from 600 trials are known to 2.9 %.
TEST(Sphere, StatesTheScatterOfItsCentre) {
  constexpr int kTrials = 600;
  constexpr double kNoise = 0.02;
  for (const bool free : {true, false}) {
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero(), stated = scatter;
    for (int trial = 0; trial < kTrials; ++trial) {
      const SphereFit fit = FitSphere(Cap(40, 1.0, kNoise, 1000 + static_cast<uint64_t>(trial)),
                                      free ? SphereChoice{} : Known(kCapRadius));
      ASSERT_THAT(fit.doubt, IsEmpty());
      scatter += (fit.centre - kCapCentre) * (fit.centre - kCapCentre).transpose() / kTrials;
      stated += fit.covariance.topLeftCorner<3, 3>() / kTrials;
    }
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(std::sqrt(stated(k, k) / scatter(k, k)), 1, 4 / std::sqrt(2.0 * kTrials)) << free << k;
  }
}

TEST(Sphere, AKnownRadiusAddsWhatItsUncertaintyMoves) {
  constexpr double kU = 1e-3;
  const auto points = Cap(40, 0.5, 1e-4);  // K b leaves out what the residuals bend: noise / radius
  const SphereFit exact = FitSphere(points, Known(kCapRadius)), considered = FitSphere(points, Known(kCapRadius, kU));
  EXPECT_EQ(considered.centre, exact.centre);
  const Eigen::Vector3d moved =
      (FitSphere(points, Known(kCapRadius + kU)).centre - FitSphere(points, Known(kCapRadius - kU)).centre) / 2;
  Eigen::Vector4d by_radius;
  by_radius << moved, kU;
  const Eigen::Matrix4d expected = by_radius * by_radius.transpose();
  EXPECT_LT((considered.covariance - exact.covariance - expected).norm(), 1e-5 * expected.norm());
  EXPECT_GT(expected(2, 2), 0.5 * kU * kU);
}

TEST(Sphere, SeenFromOutsideItsCentreLiesBehind) {
  // Flat, and bent the wrong way by 1 um: without a hint the centre of a known sphere comes to lie in front.
  std::vector<Eigen::Vector3d> points;
  for (const auto& [x, y] : {std::pair{1, 0}, {0, 1}, {-1, 0}, {0, -1}}) points.emplace_back(x, y, 100);
  points.emplace_back(0, 0, 100.001);
  SphereChoice choice = Known(50);
  EXPECT_LT(FitSphere(points, choice).centre.z(), 100);
  choice.outside = Eigen::Vector3d::Zero();
  EXPECT_NEAR(FitSphere(points, choice).centre.z(), 150, 0.02);
}

TEST(Sphere, ACircleDeterminesTheCentreOnlyOfAKnownRadius) {
  std::vector<Eigen::Vector3d> points;
  for (int k = 0; k < 8; ++k)
    points.push_back(kCapCentre + Eigen::Vector3d(3 * std::cos(0.3 * k), 3 * std::sin(0.3 * k), -4));
  EXPECT_THAT(FitSphere(points).doubt, HasSubstr("on a plane or a line"));
  SphereChoice choice = Known(5);
  choice.outside = kCapCentre - Eigen::Vector3d(0, 0, 100);
  const SphereFit fit = FitSphere(points, choice);
  EXPECT_THAT(fit.doubt, IsEmpty());
  EXPECT_LT((fit.centre - kCapCentre).norm(), 1e-9);
}

TEST(Sphere, TooFewPoints) {
  const auto points = Cap(4, 1, 0);
  EXPECT_THAT(FitSphere(points).doubt, HasSubstr("found 4 points, expected five or more"));
  EXPECT_THAT(FitSphere(points, Known(kCapRadius)).doubt, IsEmpty());
  EXPECT_THAT(FitSphere({}, Known(kCapRadius)).doubt, HasSubstr("found 0 points"));
}

}  // namespace
}  // namespace scancal
