#include "models/line/pseudo_points.h"
#include <gtest/gtest.h>
#include <Eigen/Dense>
#include "solver/random.h"

namespace scancal {
namespace {

struct Points {
  std::vector<double> y, z;
};

Points Line(size_t n, double noise, uint64_t seed) {
  Random random(seed, n);
  Points points;
  for (size_t i = 0; i < n; ++i) {
    points.z.push_back(200 * random.Uniform() - 100);
    points.y.push_back(75 + 0.3 * points.z.back() + noise * random.Normal());
  }
  return points;
}

long double Cost(const Points& points, double a, double b, double c) {
  long double sum = 0;
  for (size_t i = 0; i < points.y.size(); ++i) {
    const long double r = static_cast<long double>(a) + static_cast<long double>(b) * points.z[i] +
                          static_cast<long double>(c) * points.y[i];
    sum += r * r;
  }
  return sum;
}

double Cost(const std::array<PseudoPoint, 3>& points, double a, double b, double c) {
  double sum = 0;
  for (const PseudoPoint& p : points) sum += std::pow(p.weight * (a + b * p.z + c * p.y), 2);
  return sum;
}

TEST(PseudoPoints, StandForAnyNumberOfPoints) {
  for (const size_t n : {1, 2, 3, 4, 7, 8, 9, 15, 16, 17, 200, 1001}) {
    const Points points = Line(n, 0.05, 1);
    const auto three = PseudoPoints(Factor(points.y, points.z));
    for (const auto& [a, b, c] : {std::tuple{1.0, 0.0, 0.0}, {3.0, 0.5, 1.0}, {-75.0, -0.3, 1.0}, {0.0, 1.0, 0.0}}) {
      const double exact = static_cast<double>(Cost(points, a, b, c));
      EXPECT_NEAR(Cost(three, a, b, c), exact, 1e-11 * exact + 1e-22) << n << " points, " << a << " " << b << " " << c;
    }
  }
}

TEST(PseudoPoints, KeepTheCostAtHalfAMicrometre) {
  const Points points = Line(1000, 0.0005, 2);
  const double exact = static_cast<double>(Cost(points, -75, -0.3, 1));
  EXPECT_NEAR(Cost(PseudoPoints(Factor(points.y, points.z)), -75, -0.3, 1), exact, 1e-9 * exact);
}

TEST(PseudoPoints, StandForTenMillionPoints) {
  const Points points = Line(10'000'000, 0.05, 3);
  const double exact = static_cast<double>(Cost(points, -75, -0.3, 1));
  EXPECT_NEAR(Cost(PseudoPoints(Factor(points.y, points.z)), -75, -0.3, 1), exact, 1e-9 * exact);
}

TEST(PseudoPoints, WeighEachPoint) {
  const Points points = Line(50, 0.05, 4);
  std::vector<double> weights;
  for (size_t i = 0; i < points.y.size(); ++i) weights.push_back(1 + 0.1 * static_cast<double>(i));
  double exact = 0;
  for (size_t i = 0; i < points.y.size(); ++i)
    exact += std::pow(weights[i] * (-74 - 0.29 * points.z[i] + points.y[i]), 2);
  EXPECT_NEAR(Cost(PseudoPoints(Factor(points.y, points.z, weights)), -74, -0.29, 1), exact, 1e-11 * exact);
}

TEST(PseudoPoints, AllAtOneHeight) {
  const Points points{{1, 2, 4}, {7, 7, 7}};
  const double exact = static_cast<double>(Cost(points, -1, 0.1, 2));
  EXPECT_NEAR(Cost(PseudoPoints(Factor(points.y, points.z)), -1, 0.1, 2), exact, 1e-12 * exact);
}

TEST(FactorLine, EqualsHouseholder) {
  const Points points = Line(123, 0.05, 5);
  const std::vector<double> ones(123, 1);
  EXPECT_LT((Factor(points.y, points.z) - Factor(points.y, points.z, ones)).norm(),
            1e-12 * Factor(points.y, points.z).norm());
}

TEST(Merged, IsTheFactorOfAllPoints) {
  const Points points = Line(90, 0.05, 6);
  const std::span<const double> y = points.y, z = points.z;
  for (const std::vector<size_t>& starts : {std::vector<size_t>{0}, {0, 1}, {0, 1, 3, 40}, {0, 1, 3, 10, 30, 31, 80}}) {
    std::vector<ProfileFactor> parts;
    for (size_t k = 0; k < starts.size(); ++k) {
      const size_t count = (k + 1 < starts.size() ? starts[k + 1] : y.size()) - starts[k];
      parts.push_back(Factor(y.subspan(starts[k], count), z.subspan(starts[k], count)));
    }
    EXPECT_LT((Merged(parts) - Factor(y, z)).norm(), 1e-12 * Factor(y, z).norm()) << parts.size() << " parts";
  }
}

}  // namespace
}  // namespace scancal
