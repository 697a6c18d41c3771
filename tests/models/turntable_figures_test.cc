// The tables of a turntable's result, against what they say point by point.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include "models/turntable/residual_tables.h"
#include "models/turntable/surface.h"
#include "models/turntable/turntable_scanner.h"
#include "solver/random.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::Ge;
using ::testing::IsEmpty;
using ::testing::Le;

constexpr double kDegree = std::numbers::pi / 180;
constexpr int kPoints = 40;  // five in every segment

struct Point {
  double alpha = 0, y = 0, z = 0;
};

struct Scene {
  std::vector<std::vector<Point>> points;  // per placement
  std::vector<Placement> placements;
};

// Three bent plates before a profiler, or a lidar that stands farther back.
Scene Seen(int profiles, bool lidar = false) {
  const TurntablePose truth{123, lidar ? 50.0 : 409.0, 0, 0, 0, 0};
  Scene scene;
  Random random(1, 0);
  for (const auto& [turn, lean] : {std::pair{-25 * kDegree, 12 * kDegree}, {0, -8 * kDegree}, {25 * kDegree, 0.2}}) {
    const Eigen::Vector3d normal(std::sin(turn) * std::cos(lean), -std::cos(turn) * std::cos(lean), std::sin(lean));
    std::vector<Point>& points = scene.points.emplace_back();
    Placement& placement = scene.placements.emplace_back();
    placement.name = "plate " + std::to_string(scene.placements.size());
    placement.largest = 500;
    for (int i = 0; i < profiles; ++i) {
      const double alpha = 30 * kDegree * (i / std::max(1.0, profiles - 1.0) - 0.5);
      std::vector<double> y, z, range;
      for (int j = 0; j < kPoints; ++j) {
        z.push_back(200 * (j / (kPoints - 1.0) - 0.5));
        const Eigen::Vector3d origin = truth.Point(alpha, 0, z.back()),
                              along = truth.Point(alpha, 1, z.back()) - origin;
        y.push_back((480 - normal.dot(origin)) / normal.dot(along) + 1e-5 * z.back() * z.back() +
                    0.01 * random.Normal());
        if (lidar) range.push_back(std::hypot(y.back(), z.back()));
        points.push_back({alpha, y.back(), z.back()});
      }
      placement.profiles.push_back(CompressProfile(alpha, y, z, range));
    }
  }
  return scene;
}

TurntableScanner ScannerOf(std::vector<Placement> placements, const GridBox& box = {{110, 395}, {130, 425}, 1}) {
  TurntableDeclaration declaration;
  declaration.search = box;
  return {declaration, Turntable(Turntable::Residuals::kDepth), std::move(placements)};
}

Calibration Calibrated(const TurntableScanner& scanner, const RefineChoice& choice = {}) {
  const Result<Calibration> calibration = scanner.Calibrate(choice);
  EXPECT_TRUE(calibration.ok()) << calibration.error().message;
  return calibration.ok() ? *calibration : Calibration();
}

// Measured minus predicted along the line of sight, with the result's own numbers.
double ResidualOf(const Point& p, const Calibration& c, size_t target, bool lidar = false) {
  const TurntablePose pose{c.Find("M")->value, c.Find("N")->value, 0, 0, 0, 0};
  const Eigen::Vector3d normal = Eigen::Vector3d::Map(c.targets[target].geometry.at("normal").data()),
                        measured = pose.Point(p.alpha, p.y, p.z), from = pose.Point(p.alpha, 0, lidar ? 0 : p.z);
  return (normal.dot(measured) - c.targets[target].geometry.at("distance")[0]) /
         normal.dot((measured - from).normalized());
}

struct Direct {
  double sum = 0, count = 0;
};

Direct MeanWithin(const Scene& scene, const Calibration& c, size_t target, const std::vector<double>& cell,
                  bool lidar = false) {
  Direct direct;
  for (const Point& p : scene.points[target]) {
    if (p.alpha < cell[0] || p.alpha >= cell[1] || p.z < cell[2] - 1e-9 || p.z > cell[3] - 1e-9) continue;
    direct.sum += ResidualOf(p, c, target, lidar);
    ++direct.count;
  }
  return direct;
}

TEST(TurntableFigures, CellsAreMeansOfTheirPoints) {
  for (const int profiles : {40, 250}) {
    const Scene scene = Seen(profiles);
    const Calibration c = Calibrated(ScannerOf(scene.placements));
    for (size_t t = 0; t < c.targets.size(); ++t) {
      const NumberTable& cells = c.targets[t].residual_tables.at("cells");
      EXPECT_THAT(cells.columns, ElementsAre("alpha_from", "alpha_to", "z_from", "z_to", "residual", "points"));
      ASSERT_EQ(cells.rows.size(), static_cast<size_t>(std::min(profiles, 120) * kSegments));
      double points = 0, sum = 0;
      for (const std::vector<double>& cell : cells.rows) {
        std::vector<double> at = cell;
        // The lowest and the highest interval reach as far as an evenly spaced line is taken to, the last point belongs
        // to the one below.
        if (at[3] > 99) at[3] = 101;
        if (at[2] < -99) at[2] = -101;
        const Direct direct = MeanWithin(scene, c, t, at);
        EXPECT_EQ(cell[5], direct.count);
        EXPECT_NEAR(cell[4], direct.sum / direct.count, 1e-9);
        points += cell[5];
        sum += cell[5] * cell[4];
      }
      EXPECT_EQ(points, c.targets[t].points);
      EXPECT_NEAR(sum / points, 0, 3 * c.sigma / std::sqrt(points));  // the distance of the plane is fitted
    }
  }
}

TEST(TurntableFigures, CellsLieBesideEachOther) {
  const Calibration c = Calibrated(ScannerOf(Seen(40).placements));
  const auto& rows = c.targets[0].residual_tables.at("cells").rows;
  for (size_t i = kSegments; i < rows.size(); ++i) {
    EXPECT_NEAR(rows[i][0], rows[i - kSegments][1], 1e-12);
    EXPECT_EQ(rows[i][2], rows[i - kSegments][2]);
  }
  for (size_t i = 1; i < kSegments; ++i) EXPECT_NEAR(rows[i][2], rows[i - 1][3], 1e-9);
}

TEST(TurntableFigures, AGapInTheSweepStaysOne) {
  Scene scene = Seen(60);
  for (Placement& placement : scene.placements)
    placement.profiles.erase(placement.profiles.begin() + 20, placement.profiles.begin() + 40);
  const Calibration c = Calibrated(ScannerOf(scene.placements));
  double widest = 0;
  for (const std::vector<double>& cell : c.targets[0].residual_tables.at("cells").rows)
    widest = std::max(widest, cell[1] - cell[0]);
  EXPECT_LT(widest, 1.6 * 30 * kDegree / 59);
}

TEST(TurntableFigures, ABentPlateShowsInItsCells) {
  const Scene scene = Seen(40);
  const Calibration c = Calibrated(ScannerOf(scene.placements));
  double middle = 0, ends = 0, bend = 0;
  for (const std::vector<double>& cell : c.targets[1].residual_tables.at("cells").rows)
    (std::abs(cell[2] + cell[3]) / 2 < 50 ? middle : ends) += cell[4] / (20.0 * kSegments);
  for (const Point& p : scene.points[1]) bend += (std::abs(p.z) < 50 ? -1e-5 : 1e-5) * p.z * p.z / (40.0 * kPoints / 2);
  EXPECT_NEAR(ends - middle, bend, 0.002);
}

TEST(TurntableFigures, CellsOfALidarAreAlongTheRange) {
  const Scene scene = Seen(40, true);
  const Calibration c = Calibrated(ScannerOf(scene.placements, {{110, 30}, {130, 60}, 1}));
  double worst = 0;
  for (const std::vector<double>& cell : c.targets[2].residual_tables.at("cells").rows) {
    std::vector<double> at = cell;
    if (at[3] > 99) at[3] = 101;
    if (at[2] < -99) at[2] = -101;
    const Direct direct = MeanWithin(scene, c, 2, at, true);
    ASSERT_EQ(cell[5], direct.count);
    worst = std::max(worst, std::abs(cell[4] - direct.sum / direct.count));
  }
  EXPECT_LT(worst, 1e-3);  // the noise is ten times that
}

TEST(TurntableFigures, TheSweepIsTheMeanOfEachProfile) {
  const Scene scene = Seen(40);
  const Calibration c = Calibrated(ScannerOf(scene.placements), {.residual = "plane"});  // depth, whatever was fitted
  const NumberTable& sweep = c.targets[1].residual_tables.at("sweep");
  EXPECT_THAT(sweep.columns, ElementsAre("alpha", "residual", "u"));
  ASSERT_EQ(sweep.rows.size(), 40U);
  std::vector<double> means;
  for (size_t i = 0; i < 40; ++i) {
    double sum = 0;
    for (size_t j = 0; j < kPoints; ++j) sum += ResidualOf(scene.points[1][i * kPoints + j], c, 1);
    means.push_back(sum / kPoints);
    EXPECT_NEAR(sweep.rows[i][0], scene.points[1][i * kPoints].alpha, 1e-12);
    EXPECT_NEAR(sweep.rows[i][1], means.back(), 1e-9);
    EXPECT_NEAR(sweep.rows[i][2], scene.placements[1].Pure().sigma() / std::sqrt(kPoints), 1e-12);
  }
  const NumberTable& correlation = c.targets[1].residual_tables.at("sweep_correlation");
  EXPECT_THAT(correlation.rows.front(), ElementsAre(0, 1));
  ASSERT_EQ(correlation.rows.size(), 11U);
  double products = 0, squares = 0;
  for (size_t i = 0; i < 40; ++i) {
    squares += means[i] * means[i];
    if (i >= 3) products += means[i] * means[i - 3];
  }
  EXPECT_EQ(correlation.rows[3][0], 3);
  EXPECT_NEAR(correlation.rows[3][1], products / squares, 1e-6);
}

TEST(TurntableFigures, LongSweepsAreGrouped) {
  const Calibration c = Calibrated(ScannerOf(Seen(700).placements));
  const auto& sweep = c.targets[0].residual_tables.at("sweep").rows;
  EXPECT_EQ(sweep.size(), 600U);
  const auto [least, most] =
      std::minmax_element(sweep.begin(), sweep.end(), [](const auto& a, const auto& b) { return a[2] < b[2]; });
  EXPECT_NEAR((*most)[2] / (*least)[2], std::sqrt(2.0), 1e-9);  // one profile or two
  EXPECT_EQ(c.targets[0].residual_tables.at("sweep_correlation").rows.size(), 61U);
}

void ExpectClose(const NumberTables& a, const NumberTables& b) {
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, table] : a) {
    const NumberTable& other = b.at(name);
    ASSERT_EQ(table.rows.size(), other.rows.size()) << name;
    for (size_t i = 0; i < table.rows.size(); ++i)
      for (size_t k = 0; k < table.columns.size(); ++k) EXPECT_NEAR(table.rows[i][k], other.rows[i][k], 1e-7) << name;
  }
}

TEST(TurntableFigures, TheOrderOfProfilesAndTargetsDoesNotMatter) {
  Scene scene = Seen(130);
  const Calibration a = Calibrated(ScannerOf(scene.placements));
  for (Placement& placement : scene.placements)
    for (size_t i = 0; i < 130; ++i) std::swap(placement.profiles[i], placement.profiles[(i * 37) % 130]);
  std::reverse(scene.placements.begin(), scene.placements.end());
  const Calibration b = Calibrated(ScannerOf(scene.placements));
  ExpectClose(a.surface, b.surface);
  for (size_t t = 0; t < 3; ++t) {
    ExpectClose(a.targets[t].residual_tables, b.targets[2 - t].residual_tables);
    ExpectClose(a.targets[t].scene, b.targets[2 - t].scene);
  }
}

TEST(TurntableFigures, NoProfileOneProfileAndOneAngleHaveTablesToo) {
  Turntable::Target target;
  Turntable::SetPlane({0, -1, 0}, 480, &target);
  std::vector<double> values(Turntable(Turntable::Residuals::kDepth).quantities().size());
  values[Turntable::kN] = 409;
  const ScannedVolume volume{};
  EXPECT_THAT(ResidualTables({Placement(), target, values, volume}), IsEmpty());
  Placement one;
  one.profiles = {CompressProfile(0, std::vector{71.5}, std::vector{3.0}, {})};
  NumberTables tables = ResidualTables({one, target, values, volume});
  EXPECT_THAT(tables.at("cells").rows, ElementsAre(ElementsAre(0, 0, 3, 3, 0.5, 1)));
  EXPECT_THAT(tables.at("sweep").rows, ElementsAre(ElementsAre(0, 0.5, 0)));
  EXPECT_THAT(tables.at("sweep_correlation").rows, ElementsAre(ElementsAre(0, 1)));
  one.profiles.push_back(CompressProfile(0, std::vector{70.5}, std::vector{5.0}, {}));  // a second sweep
  tables = ResidualTables({one, target, values, volume});
  EXPECT_THAT(tables.at("cells").rows, ElementsAre(ElementsAre(0, 0, 3, 5, 0, 2)));
  EXPECT_EQ(tables.at("sweep").rows.size(), 1U);
}

TEST(TurntableFigures, TheSurfaceSpansTheSearchAndTheResult) {
  const TurntableScanner scanner = ScannerOf(Seen(40).placements, {{110.5, 395}, {130.5, 425}, 0.1});
  const Calibration c = Calibrated(scanner);
  const TurntableStart start = *scanner.Initialize();
  for (const auto& [name, size] : {std::pair{"search", 61U * 61U}, {"near", 41U * 41U}}) {
    const NumberTable& table = c.surface.at(name);
    EXPECT_THAT(table.columns, ElementsAre("M", "N", "S"));
    ASSERT_EQ(table.rows.size(), size);
    for (const std::vector<double>& row : table.rows) {
      double sum = 0;
      for (const PlaneStorey& storey : start.storeys) sum += storey.Rmse(row[0], row[1], PlaneFit::kOrthogonal);
      EXPECT_DOUBLE_EQ(row[2], sum / 3);
      if (std::string(name) == "search") {
        EXPECT_GE(row[2], c.grid.S);  // of its nodes the grid took the least
      }
    }
    EXPECT_LT(table.rows[0][1], table.rows[1][1]);  // N faster
  }
  const auto &search = c.surface.at("search").rows, &near = c.surface.at("near").rows;
  EXPECT_THAT(search.front(), ElementsAre(110.5, 395, Ge(c.grid.S)));
  EXPECT_NEAR(search.back()[0], 130.5, 1e-9);
  EXPECT_NEAR(search.back()[1], 425, 1e-9);
  const std::vector<double>& middle = near[near.size() / 2];
  for (const size_t k : {0, 1}) {
    const Parameter& p = *c.Find(k == 0 ? "M" : "N");
    EXPECT_EQ(middle[k], p.value);
    const double reach = p.value - near.front()[k];
    EXPECT_NEAR(near.back()[k] - p.value, reach, 1e-9);
    EXPECT_GE(reach, (3 - 1e-9) * p.U);
    if (std::abs(c.grid.at[k] - p.value) < 0.3) {
      EXPECT_GT(reach, std::abs(c.grid.at[k] - p.value));
    }
  }
  EXPECT_NEAR(near.back()[0] - near.front()[0], near.back()[1] - near.front()[1], 1e-9);
}

TEST(TurntableFigures, AFarGridMinimumDoesNotWidenTheSurface) {
  const Calibration c = Calibrated(ScannerOf(Seen(40).placements, {{110, 395}, {115, 425}, 1}));
  const auto& near = c.surface.at("near").rows;
  EXPECT_GT(near.front()[0], 120);
}

TEST(TurntableFigures, WhatIsHeldHasOneNode) {
  TurntableDeclaration declaration;
  declaration.search = {{110, 395}, {130, 425}, 1};
  Turntable model(Turntable::Residuals::kDepth);
  model.quantity(Turntable::kM).role = Role::kHold;
  model.quantity(Turntable::kM).value = 123;
  const Calibration c = Calibrated({declaration, model, Seen(40).placements});
  EXPECT_EQ(c.surface.at("search").rows.size(), 31U);
  EXPECT_EQ(c.surface.at("near").rows.size(), 41U);
  EXPECT_EQ(c.surface.at("near").rows.front()[0], 123);
}

TEST(TurntableFigures, TheSceneStandsInTheTableFrame) {
  const Scene scene = Seen(40);
  const Calibration c = Calibrated(ScannerOf(scene.placements));
  const double radius = std::hypot(c.Find("M")->value, c.Find("N")->value);
  for (const TargetSummary& target : c.targets) {
    const Eigen::Vector3d normal = Eigen::Vector3d::Map(target.geometry.at("normal").data());
    const double distance = target.geometry.at("distance")[0];
    const auto &outline = target.scene.at("outline").rows, &views = target.scene.at("views").rows;
    ASSERT_EQ(outline.size(), 19U);
    EXPECT_EQ(outline.front(), outline.back());
    for (const std::vector<double>& corner : outline) {
      EXPECT_NEAR(normal.dot(Eigen::Vector3d::Map(corner.data())), distance, 1e-9);
      EXPECT_NEAR(std::abs(corner[2]), 100, 8);  // the line is 200 mm long; its ends are told from its spread
    }
    ASSERT_EQ(views.size(), 9U);
    for (const std::vector<double>& view : views) {
      EXPECT_NEAR(std::hypot(view[0], view[1]), radius, 1e-9);
      EXPECT_EQ(view[2], 0);
      EXPECT_NEAR(normal.dot(Eigen::Vector3d::Map(view.data() + 3)), distance, 0.1);
      EXPECT_NEAR(view[5], 0, 1e-6);
    }
    const TurntablePose pose{c.Find("M")->value, c.Find("N")->value, 0, 0, 0, 0};
    EXPECT_NEAR((Eigen::Vector3d::Map(views[0].data()) - pose.Point(-15 * kDegree, 0, 0)).norm(), 0, 1e-9);
    EXPECT_NEAR((Eigen::Vector3d::Map(views[8].data()) - pose.Point(15 * kDegree, 0, 0)).norm(), 0, 1e-9);
  }
}

TEST(TurntableFigures, WhatWasDeclaredIsListed) {
  TurntableDeclaration declaration;
  declaration.search = {{110, 395}, {130, 425}, 1};
  Turntable model(Turntable::Residuals::kDepth);
  model.quantity(Turntable::kScaleY).role = Role::kConsider;
  model.quantity(Turntable::kScaleY).u = 1e-4;
  model.quantity(Turntable::kM).u = 0.5;
  model.quantity(Turntable::kM).value = 122.9;
  const Calibration c = Calibrated({declaration, model, Seen(40).placements});
  EXPECT_EQ(std::pair(c.Find("M")->prior, c.Find("M")->prior_u), std::pair(122.9, 0.5));
  EXPECT_EQ(c.Find("N")->prior_u, 0);
  std::map<std::string, Influence> by_source;
  for (const Influence& influence : c.influences) by_source[influence.source] = influence;
  EXPECT_EQ(by_source.size(), c.influences.size());
  EXPECT_EQ(by_source.count("M") + by_source.count("normal_1"), 0U);
  EXPECT_EQ(std::tuple(by_source["scale_y"].role, by_source["scale_y"].u), std::tuple(Role::kConsider, 1e-4));
  EXPECT_EQ(std::tuple(by_source["form"].role, by_source["form"].u), std::tuple(Role::kHold, 0.0));
  EXPECT_EQ(by_source["noise_y"].role, Role::kEstimate);
  EXPECT_NEAR(by_source["noise_y"].u, c.lack_of_fit.pure_error_sigma, 1e-3);
  EXPECT_EQ(by_source["encoder_jitter"].scope, Scope::kView);
}

TEST(TurntableFigures, ABriefComparisonLeavesOutWhatTakesLong) {
  std::vector<Placement> many;
  for (int copy = 0; copy < 16; ++copy)
    for (Placement& placement : Seen(30).placements) many.push_back(placement);
  const Result<Comparison> few = ScannerOf(Seen(30).placements).Compare({.brief = true}),
                           all = ScannerOf(many).Compare({.brief = true});
  ASSERT_TRUE(few.ok() && all.ok());
  constexpr size_t kHeldOut = 6;
  ASSERT_EQ(few->columns[kHeldOut].name, "held out/um");
  ASSERT_EQ(few->rows.size(), 10U);
  EXPECT_EQ(few->rows[1].note, "");  // step 0.1: 60,501 nodes
  EXPECT_THAT(few->rows[2].note, ::testing::HasSubstr("left out"));
  EXPECT_THAT(all->rows[1].note, ::testing::HasSubstr("left out"));  // of 48 placements
  EXPECT_TRUE(few->rows.back().cells[kHeldOut].value);
  EXPECT_FALSE(all->rows.back().cells[kHeldOut].value);  // 48 fits of 1440 profiles
  EXPECT_TRUE(all->rows[0].cells[kHeldOut].value);       // a grid has it for nothing
}

}  // namespace
}  // namespace scancal
