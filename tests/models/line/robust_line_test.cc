#include "models/line/robust_line.h"
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include "solver/random.h"

namespace scancal {
namespace {

struct Profile {
  std::vector<double> y, z;
};

// y = 10 + 0.2 z; the first `share` of the line lies `behind` it.
Profile WithBackground(int n, double share, double behind, uint64_t seed) {
  Random random(seed, 0);
  Profile points;
  for (int i = 0; i < n; ++i) {
    points.z.push_back(200.0 * i / n - 100);
    points.y.push_back(10 + 0.2 * points.z.back() + 0.05 * random.Normal() + (i < share * n ? behind : 0));
  }
  return points;
}

double WorstDistance(const RobustLine& line) {
  double worst = 0;
  for (const double z : {-100.0, 0.0, 100.0}) worst = std::max(worst, std::abs(line.Distance(10 + 0.2 * z, z)));
  return worst;
}

TEST(RobustLine, FindsTheLineUnderBackground) {
  for (const double share : {0.0, 0.1, 0.3, 0.4}) {
    for (uint64_t seed = 1; seed <= 20; ++seed) {
      const Profile points = WithBackground(200, share, 40, seed);
      const RobustLine line = FitRobustLine(points.y, points.z);
      EXPECT_LT(WorstDistance(line), 0.05) << share << " " << seed;
      EXPECT_TRUE(share > 0.2 || std::abs(line.scale / (0.05 * std::cos(std::atan(0.2))) - 1) < 0.35) << line.scale;
    }
  }
}

TEST(RobustLine, DoesNotDependOnTheOrderOfPoints) {
  Profile points = WithBackground(101, 0.3, 40, 1);
  const RobustLine forward = FitRobustLine(points.y, points.z);
  std::reverse(points.y.begin(), points.y.end());
  std::reverse(points.z.begin(), points.z.end());
  const RobustLine backward = FitRobustLine(points.y, points.z);
  EXPECT_NEAR(forward.Distance(0, 0), backward.Distance(0, 0), 1e-10);
  EXPECT_NEAR(forward.scale, backward.scale, 1e-10);
}

TEST(RobustLine, RunsAlongDepthToo) {  // a lidar's fan may see a wall edge-on to its y axis
  const Profile points = WithBackground(100, 0, 0, 2);
  const RobustLine line = FitRobustLine(points.z, points.y);
  EXPECT_NEAR(std::abs(line.dy), 1 / std::sqrt(1.04), 1e-3);
}

TEST(RobustLine, TakesFewPointsAsTheyAre) {
  for (size_t n = 0; n < 5; ++n) {
    const std::vector<double> y(n, 3.0), z(n, 1.0);
    EXPECT_EQ(FitRobustLine(y, z).scale, 0);
  }
}

TEST(Resolution, IsTheStepOfAQuantisedSensor) {
  std::vector<double> values;
  Random random(3, 0);
  for (int i = 0; i < 100; ++i) values.push_back(0.25 * std::round(4 * random.Normal()));
  EXPECT_EQ(Resolution(values), 0.25);
  for (double& value : values) value = random.Normal();
  EXPECT_EQ(Resolution(values), 0);
}

}  // namespace
}  // namespace scancal
