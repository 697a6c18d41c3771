// The tables of a turntable's result, against what they say point by point.
#include "models/turntable/tables.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include "tests/models/turntable/bent_plates.h"

namespace scancal::turntable {
namespace {

using namespace bent_plates;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

struct Direct {
  double sum = 0, count = 0;
};

Direct MeanWithin(const ScannedPlates& scene, const Calibration& c, size_t target, const std::vector<double>& cell,
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
    const ScannedPlates scene = Scanned(profiles);
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
  const Calibration c = Calibrated(ScannerOf(Scanned(40).placements));
  const auto& rows = c.targets[0].residual_tables.at("cells").rows;
  for (size_t i = kSegments; i < rows.size(); ++i) {
    EXPECT_NEAR(rows[i][0], rows[i - kSegments][1], 1e-12);
    EXPECT_EQ(rows[i][2], rows[i - kSegments][2]);
  }
  for (size_t i = 1; i < kSegments; ++i) EXPECT_NEAR(rows[i][2], rows[i - 1][3], 1e-9);
}

TEST(TurntableFigures, AGapInTheSweepStaysOne) {
  ScannedPlates scene = Scanned(60);
  for (Placement& placement : scene.placements)
    placement.profiles.erase(placement.profiles.begin() + 20, placement.profiles.begin() + 40);
  const Calibration c = Calibrated(ScannerOf(scene.placements));
  double widest = 0;
  for (const std::vector<double>& cell : c.targets[0].residual_tables.at("cells").rows)
    widest = std::max(widest, cell[1] - cell[0]);
  EXPECT_LT(widest, 1.6 * 30 * kDegree / 59);
}

TEST(TurntableFigures, ABentPlateShowsInItsCells) {
  const ScannedPlates scene = Scanned(40);
  const Calibration c = Calibrated(ScannerOf(scene.placements));
  double middle = 0, ends = 0, bend = 0;
  for (const std::vector<double>& cell : c.targets[1].residual_tables.at("cells").rows)
    (std::abs(cell[2] + cell[3]) / 2 < 50 ? middle : ends) += cell[4] / (20.0 * kSegments);
  for (const Point& p : scene.points[1]) bend += (std::abs(p.z) < 50 ? -1e-5 : 1e-5) * p.z * p.z / (40.0 * kPoints / 2);
  EXPECT_NEAR(ends - middle, bend, 0.002);
}

TEST(TurntableFigures, CellsOfALidarAreAlongTheRange) {
  const ScannedPlates scene = Scanned(40, true);
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
  const ScannedPlates scene = Scanned(40);
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

TEST(TurntableFigures, ASweepThatTurnsBackIsShownInTime) {
  ScannedPlates scene = Scanned(40);
  std::vector<Profile>& profiles = scene.placements[1].profiles;
  for (size_t k = 0; k < 40; ++k) profiles[k].time = static_cast<double>(k % 2 == 0 ? k / 2 : 39 - k / 2);
  const Calibration c = Calibrated(ScannerOf(scene.placements));
  EXPECT_FALSE(c.targets[0].residual_tables.contains("time"));  // never turns back
  const auto& in_time = c.targets[1].residual_tables.at("time").rows;
  const auto& sweep = c.targets[1].residual_tables.at("sweep").rows;
  ASSERT_EQ(in_time.size(), 40U);
  for (size_t row = 0; row < 40; ++row) {
    const std::vector<double>& at = sweep[row < 20 ? 2 * row : 2 * (39 - row) + 1];
    EXPECT_EQ(in_time[row][0], static_cast<double>(row));
    for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(in_time[row][k + 1], at[k], 1e-12);
  }
}

TEST(TurntableFigures, LongSweepsAreGrouped) {
  const Calibration c = Calibrated(ScannerOf(Scanned(700).placements));
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
  ScannedPlates scene = Scanned(130);
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
  Model::Target target;
  Model::SetPlane({0, -1, 0}, 480, &target);
  target.views.resize(2);  // as many as there are profiles, at rest
  std::vector<double> values(Model(Model::Residuals::kDepth).quantities().size());
  values[Model::kN] = 409;
  System system;
  system[Model::kN] = 409;
  EXPECT_THAT(ResidualTables({Placement(), target, values, system}), IsEmpty());
  Placement one;
  one.profiles = {CompressProfile(0, std::vector{71.5}, std::vector{3.0}, {})};
  NumberTables tables = ResidualTables({one, target, values, system});
  EXPECT_THAT(tables.at("cells").rows, ElementsAre(ElementsAre(0, 0, 3, 3, 0.5, 1)));
  EXPECT_THAT(tables.at("sweep").rows, ElementsAre(ElementsAre(0, 0.5, 0)));
  EXPECT_THAT(tables.at("sweep_correlation").rows, ElementsAre(ElementsAre(0, 1)));
  one.profiles.push_back(CompressProfile(0, std::vector{70.5}, std::vector{5.0}, {}));  // a second sweep
  tables = ResidualTables({one, target, values, system});
  EXPECT_THAT(tables.at("cells").rows, ElementsAre(ElementsAre(0, 0, 3, 5, 0, 2)));
  EXPECT_EQ(tables.at("sweep").rows.size(), 1U);
}

}  // namespace
}  // namespace scancal::turntable
