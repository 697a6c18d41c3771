#include <gmock/gmock.h>
#include <numbers>
#include "models/sphere.h"
#include "solver/random.h"

namespace scancal {
namespace {

using ::testing::IsEmpty;

const Eigen::Vector3d kCentre(40, -25, 600);
constexpr double kRadius = 6.35, kNoise = 0.02;

// n points of the cap that faces the origin, the first `off` of them on a stem behind and a floor.
std::vector<Eigen::Vector3d> Points(int n, int off, uint64_t seed) {
  Random random(seed, 0);
  std::vector<Eigen::Vector3d> points;
  for (int k = 0; k < n; ++k) {
    const double phi = 2 * std::numbers::pi * random.Uniform(), c = 1 - 0.5 * random.Uniform(),
                 s = std::sqrt(1 - c * c);
    const Eigen::Vector3d on(s * std::cos(phi), s * std::sin(phi), -c);
    const Eigen::Vector3d stem(2 * random.Uniform(), 1, 7 + 10 * random.Uniform()),
        floor(20 * random.Uniform(), -15, 8);
    points.push_back(kCentre + (k >= off ? (kRadius + kNoise * random.Normal()) * on : k % 2 ? stem : floor));
  }
  return points;
}

TEST(RobustSphere, PointsElsewhereDoNotMoveIt) {
  for (const bool known : {true, false}) {
    const SphereChoice choice = known ? SphereChoice{KnownRadius{kRadius, 0}, {}} : SphereChoice{};
    const auto points = Points(300, 105, 1);
    const RobustSphere robust = FitRobustSphere(points, choice);
    EXPECT_THAT(robust.fit.doubt, IsEmpty());
    const SphereFit good = FitSphere(std::span(points).subspan(105), choice);
    EXPECT_LT((robust.fit.centre - good.centre).norm(), 1e-9);
    EXPECT_NEAR(robust.fit.sigma / good.sigma, 1, 1e-9);
    EXPECT_EQ(robust.set_aside, 105);
    for (size_t k = 0; k < 105; ++k) EXPECT_TRUE(robust.off[k]) << k;
  }
}

TEST(RobustSphere, WithoutOthersItIsTheFit) {
  const auto points = Points(200, 0, 2);
  const RobustSphere robust = FitRobustSphere(points, {KnownRadius{kRadius, 0}, {}});
  EXPECT_EQ(robust.set_aside, 0);
  EXPECT_EQ(robust.fit.centre, FitSphere(points, {KnownRadius{kRadius, 0}, {}}).centre);
}

TEST(RobustSphere, ExactPoints) {
  std::vector<Eigen::Vector3d> points;
  for (int k = 0; k < 50; ++k)
    points.push_back(kCentre + kRadius * Eigen::Vector3d(std::sin(k), std::cos(k), -0.2 * (k % 5) - 0.5).normalized());
  const RobustSphere robust = FitRobustSphere(points);
  EXPECT_EQ(robust.set_aside, 0);
  EXPECT_LT((robust.fit.centre - kCentre).norm(), 1e-9);
  EXPECT_NEAR(robust.fit.radius, kRadius, 1e-9);
}

TEST(RobustSphere, FewPointsAreNeverOff) {
  auto points = Points(7, 0, 3);
  points[3] += Eigen::Vector3d(0, 0, 1);
  EXPECT_EQ(FitRobustSphere(points).set_aside, 0);
  EXPECT_FALSE(FitRobustSphere({}).fit.doubt.empty());
}

}  // namespace
}  // namespace scancal
