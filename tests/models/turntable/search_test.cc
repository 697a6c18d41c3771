// The published equations, and the compressed search that must reproduce them.
#include "models/turntable/search.h"
#include <gtest/gtest.h>
#include "solver/dense.h"
#include "solver/random.h"
#include "tests/models/turntable/scene.h"
#include "tests/reference/zhao_2021.h"

namespace scancal::turntable {
namespace {

using zhao_2021::Measurement;

Scene CoarseScene() {
  Scene scene;
  scene.profiles = 15;
  scene.points = 8;
  return scene;
}

std::vector<std::vector<Measurement>> Measurements(const std::vector<SimulatedPlacement>& placements) {
  std::vector<std::vector<Measurement>> result;
  for (const SimulatedPlacement& placement : placements) {
    auto& points = result.emplace_back();
    for (const SimulatedProfile& profile : placement.profiles)
      for (size_t i = 0; i < profile.y.size(); ++i) points.push_back({profile.alpha, profile.y[i], profile.z[i]});
  }
  return result;
}

std::vector<PlaneStorey> Storeys(const std::vector<SimulatedPlacement>& placements) {
  std::vector<PlaneStorey> storeys;
  for (const SimulatedPlacement& placement : placements) storeys.emplace_back(Compress(placement), System{});
  return storeys;
}

TEST(Zhao2021, Equation7IsTheSimplifiedModelWhereItHolds) {
  for (const double M : {0.0, 1e-3, 50.0, 123.0})
    for (const double N : {-20.0, 0.0, 409.0})
      for (const double y : {20.001, 75.0, 300.0})
        for (double alpha = -3; alpha <= 3; alpha += 0.37) {
          const Eigen::Vector3d p = System{{M, N}, {}}.Point(alpha, y, -12);
          EXPECT_LT((zhao_2021::Transform(M, N, {alpha, y, -12}) - p).norm(), 1e-10);
          EXPECT_NEAR(p.x(), M * std::cos(alpha) - (N + y) * std::sin(alpha), 1e-10);
          EXPECT_NEAR(p.y(), -M * std::sin(alpha) - (N + y) * std::cos(alpha), 1e-10);
        }
}

TEST(Zhao2021, Equation7IsWrongElsewhereAsPrinted) {
  const Measurement p{0.2, 75, 0};
  EXPECT_GT((zhao_2021::Transform(-123, 409, p) - System{{-123, 409}, {}}.Point(0.2, 75, 0)).norm(), 100);
  EXPECT_GT((zhao_2021::Transform(123, -409, p) - System{{123, -409}, {}}.Point(0.2, 75, 0)).norm(), 100);
}

TEST(Zhao2021, FitsAPlaneByLeastSquaresInZ) {
  const std::vector<Eigen::Vector3d> points = {{0, 0, 1}, {1, 0, 3}, {0, 1, 0}, {1, 1, 2}};  // Z = 2 X - Y + 1
  const zhao_2021::Plane plane = zhao_2021::FitPlane(points);
  EXPECT_NEAR(plane.A, 2, 1e-14);
  EXPECT_NEAR(plane.B, -1, 1e-14);
  EXPECT_NEAR(plane.C, 1, 1e-14);
  EXPECT_NEAR(zhao_2021::Rmse({2, -1, 0}, points), 1 / std::sqrt(6), 1e-14);  // all of them one off in Z
}

TEST(Zhao2021, TheCompressedSearchGivesThePublishedSAtEveryNode) {
  const auto placements = Simulate(CoarseScene());
  const auto points = Measurements(placements);
  const auto storeys = Storeys(placements);
  for (double M = 110; M <= 130; M += 2.5)
    for (double N = 395; N <= 425; N += 5) {
      double S = 0;
      for (const PlaneStorey& storey : storeys) S += storey.Rmse(M, N, PlaneFit::kVertical) / 3;
      EXPECT_NEAR(S, zhao_2021::S(M, N, points), 1e-9 * S) << M << " " << N;
    }
}

TEST(Zhao2021, TheCompressedSearchFindsThePublishedMinimum) {
  const auto placements = Simulate(CoarseScene());
  const GridBox box{{110, 395}, {130, 425}, 1};
  const GridResult published = zhao_2021::Search(box, Measurements(placements));
  const auto storeys = Storeys(placements);
  const GridResult compressed = GridSearch(box, 3, [&](const auto& at, std::span<double> rmse) {
    for (size_t t = 0; t < 3; ++t) rmse[t] = storeys[t].Rmse(at[0], at[1], PlaneFit::kVertical);
  });
  EXPECT_EQ(published.nodes, 651);
  EXPECT_EQ(published.best.at, compressed.best.at);
  EXPECT_NEAR(published.best.value, compressed.best.value, 1e-9);
}

TEST(PlaneStorey, OrthogonalRmseIsTheSmallestSingularValue) {
  const auto placements = Simulate(CoarseScene());
  const auto points = Measurements(placements)[0];
  const PlaneStorey storey = Storeys(placements)[0];
  for (const auto& [M, N] : {std::pair{123.0, 409.0}, {100.0, 450.0}, {-50.0, 0.0}}) {
    Eigen::MatrixXd rows(std::ssize(points), 3);
    for (Eigen::Index i = 0; i < rows.rows(); ++i)
      rows.row(i) = System{{M, N}, {}}.Point(points[i].alpha, points[i].y, points[i].z).transpose();
    const Eigen::MatrixXd centred = rows.rowwise() - rows.colwise().mean();
    const Svd svd = SvdOf(centred);
    const double expected = svd.values[2] / std::sqrt(static_cast<double>(rows.rows()));
    EXPECT_NEAR(storey.Rmse(M, N, PlaneFit::kOrthogonal), expected, 1e-9 * expected);
    const auto [normal, distance] = storey.FitPlane(M, N);
    EXPECT_NEAR(std::abs(normal.dot(svd.v.col(2))), 1, 1e-9);
    EXPECT_NEAR(distance, std::abs(normal.dot(rows.colwise().mean())), 1e-9);
  }
}

TEST(PlaneStorey, ThePublishedFitFailsOnAPlateParallelToTheAxis) {
  std::vector<Profile> profiles;
  Random random(1, 0);
  for (int k = 0; k <= 20; ++k) {
    const double alpha = -0.25 + 0.025 * k, depth = (500 - 123 * std::sin(alpha)) / std::cos(alpha) - 409;
    std::vector<double> y, z;
    for (int i = 0; i < 20; ++i) {
      y.push_back(depth + 0.05 * random.Normal());
      z.push_back(10.0 * i - 100);
    }
    profiles.push_back(CompressProfile(alpha, y, z, {}));
  }
  const PlaneStorey storey(profiles, System{});
  EXPECT_NEAR(storey.Rmse(123, 409, PlaneFit::kOrthogonal), 0.05, 0.005);
  EXPECT_GT(storey.Rmse(123, 409, PlaneFit::kVertical), 20 * 0.05);
}

TEST(PlaneStorey, KnowsTheTilts) {
  Scene scene = CoarseScene();
  scene.system[Model::kTiltX] = 0.02;
  scene.system[Model::kTiltY] = -0.03;
  scene.noise_y = 0;
  const auto placements = Simulate(scene);
  const PlaneStorey knowing(Compress(placements[0]), scene.system);
  EXPECT_LT(knowing.Rmse(123, 409, PlaneFit::kOrthogonal), 1e-10);
  EXPECT_GT(Storeys(placements)[0].Rmse(123, 409, PlaneFit::kOrthogonal), 0.1);
}

}  // namespace
}  // namespace scancal::turntable
