// What a compressed profile keeps: segments, pure error, residuals from its own line.
#include <gtest/gtest.h>
#include <algorithm>
#include <numeric>
#include "models/turntable/compress.h"
#include "solver/random.h"

namespace scancal::turntable {
namespace {

struct Points {
  std::vector<double> y, z, range;
};

// On a slanted line, in the order of z.
Points Line(size_t n, double noise, uint64_t seed) {
  Random random(seed, n);
  Points points;
  for (size_t i = 0; i < n; ++i) points.z.push_back(200 * random.Uniform() - 100);
  std::sort(points.z.begin(), points.z.end());
  for (const double z : points.z) points.y.push_back(75 + 0.3 * z + noise * random.Normal());
  return points;
}

// A wall 2 m ahead, slanted against the fan: noise of 10 mm along the range only.
Points Wall(uint64_t seed) {
  Random random(seed, 0);
  Points points;
  for (int i = 0; i < 4000; ++i) {
    const double bearing = -0.9 + 1.8 * i / 4000;
    points.range.push_back(2000 / (std::cos(bearing) + 0.4 * std::sin(bearing)) + 10 * random.Normal());
    points.y.push_back(points.range.back() * std::cos(bearing));
    points.z.push_back(points.range.back() * std::sin(bearing));
  }
  return points;
}

Points Shuffled(const Points& points, uint64_t seed) {
  Random random(seed, 0);
  Points shuffled = points;
  for (size_t i = shuffled.y.size(); i > 1; --i) {
    const auto j = static_cast<size_t>(random.Uniform() * static_cast<double>(i));
    for (auto* column : {&shuffled.y, &shuffled.z, &shuffled.range})
      if (!column->empty()) std::swap((*column)[i - 1], (*column)[j]);
  }
  return shuffled;
}

Profile Compressed(const Points& points) { return CompressProfile(0.1, points.y, points.z, points.range); }

TEST(CompressProfile, ItsSegmentsMergeToTheFactorOfAllPoints) {
  for (const size_t n : {1, 2, 3, 4, 5, 9, 33, 200, 1001}) {
    const Points points = Line(n, 0.05, 1);
    const Profile profile = Compressed(points);
    const ProfileFactor direct = Factor(points.y, points.z);
    EXPECT_LT((profile.factor - direct).norm(), 1e-12 * direct.norm()) << n;
    double count = 0;
    for (const ProfileFactor& segment : profile.segments) count += segment(0, 0) * segment(0, 0);
    EXPECT_NEAR(count, static_cast<double>(n), 1e-12 * static_cast<double>(n));
  }
}

TEST(CompressProfile, ItsSegmentsAreExactForWhatDiffersFromOneToTheOther) {
  const Points points = Line(500, 0.05, 2);
  const Profile profile = Compressed(points);
  ASSERT_EQ(profile.segments.size(), 8U);
  const double width = (points.z.back() - points.z.front()) / 8;
  for (int k = 0; k < 8; ++k) {
    const double a = -75 + 0.02 * k, b = -0.3 + 1e-4 * k;
    double exact = 0;
    for (size_t i = 0; i < points.z.size(); ++i)
      if (std::clamp(static_cast<int>((points.z[i] - points.z.front()) / width), 0, 7) == k)
        exact += std::pow(a + b * points.z[i] + points.y[i], 2);
    double compressed = 0;
    for (const PseudoPoint& p : PseudoPoints(profile.segments[static_cast<size_t>(k)]))
      compressed += std::pow(p.weight * (a + b * p.z + p.y), 2);
    EXPECT_NEAR(compressed, exact, 1e-10 * exact) << k;
  }
}

TEST(CompressProfile, TheOrderOfPointsDoesNotMatter) {
  for (const Points& points : {Line(301, 0.05, 3), Wall(3)}) {
    const Profile a = Compressed(points), b = Compressed(Shuffled(points, 4));
    ASSERT_EQ(a.segments.size(), b.segments.size());
    for (size_t k = 0; k < a.segments.size(); ++k)
      EXPECT_LT((a.segments[k] - b.segments[k]).norm(), 1e-12 * a.segments[k].norm());
    EXPECT_NEAR(a.pure_error.sigma(), b.pure_error.sigma(), 1e-9 * a.pure_error.sigma());
    EXPECT_EQ(a.ranged.has_value(), b.ranged.has_value());
    if (a.ranged && b.ranged) {
      EXPECT_LT((*a.ranged - *b.ranged).norm(), 1e-12 * a.ranged->norm());
    }
  }
}

TEST(CompressProfile, SegmentsWithoutPointsAreLeftOut) {
  Points points = Line(100, 0.05, 5);
  for (size_t i = 0; i < 100; ++i) points.z[i] = i < 50 ? -100 + 0.1 * static_cast<double>(i) : 100;
  const Profile profile = Compressed(points);
  ASSERT_EQ(profile.segments.size(), 2U);
  EXPECT_NEAR(profile.segments[0](0, 0), std::sqrt(50.0), 1e-12);
  EXPECT_EQ(profile.segments[1](1, 1), 0);  // all at one height
}

TEST(CompressProfile, OfOneHeightIsOneSegment) {
  const Points points{{1, 2, 4}, {7, 7, 7}, {}};
  const Profile profile = Compressed(points);
  ASSERT_EQ(profile.segments.size(), 1U);
  EXPECT_EQ(profile.segments[0], profile.factor);
  const std::vector<double> residuals = ResidualsFromLine(profile, points.y, points.z);
  EXPECT_NEAR(residuals[2], 4 - 7.0 / 3, 1e-12);
}

TEST(CompressProfile, OfOnePointHasNoDegreesOfFreedom) {
  const Points points{{70}, {3}, {}};
  EXPECT_EQ(Compressed(points).pure_error.dof, 0);
  EXPECT_EQ(Compressed(points).segments.size(), 1U);
}

TEST(CompressProfile, KnowsThePureErrorOfDepth) {
  const Profile profile = Compressed(Line(4000, 0.05, 6));
  EXPECT_EQ(profile.pure_error.dof, 3998);
  EXPECT_NEAR(profile.pure_error.sigma(), 0.05, 4 * 0.05 / std::sqrt(2 * 3998.0));
}

TEST(CompressProfile, KnowsThePureErrorOfALidarAlongTheRange) {
  EXPECT_NEAR(Compressed(Wall(7)).pure_error.sigma(), 10, 4 * 10 / std::sqrt(2 * 3998.0));
}

TEST(ResidualsFromLine, AreWhatThePureErrorAddsUp) {
  for (const Points& points : {Line(1000, 0.05, 8), Wall(8)}) {
    const Profile profile = Compressed(points);
    const std::vector<double> residuals = ResidualsFromLine(profile, points.y, points.z);
    const double squares = std::inner_product(residuals.begin(), residuals.end(), residuals.begin(), 0.0);
    // The lidar's pure error is of the same line to first order in noise / range, 0.005.
    EXPECT_NEAR(squares / profile.pure_error.sum_of_squares, 1, profile.ranged ? 1e-3 : 1e-9);
  }
}

TEST(ResidualsFromLine, ArePositiveBehindTheLine) {
  for (Points points : {Line(1000, 0.05, 9), Wall(9)}) {
    const bool lidar = !points.range.empty();
    (lidar ? points.range[10] : points.y[10]) += lidar ? 200 : 1;
    if (lidar) {
      points.y[10] *= points.range[10] / (points.range[10] - 200);
      points.z[10] *= points.range[10] / (points.range[10] - 200);
    }
    EXPECT_NEAR(ResidualsFromLine(Compressed(points), points.y, points.z)[10], lidar ? 200 : 1, lidar ? 40 : 0.2);
  }
}

}  // namespace
}  // namespace scancal::turntable
