// Tables for the figures of the surface and the scene, what was declared, and the brief comparison.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include "models/turntable/search.h"
#include "tests/models/turntable/bent_plates.h"

namespace scancal::turntable {
namespace {

using namespace bent_plates;
using ::testing::ElementsAre;
using ::testing::Ge;

TEST(TurntableFigures, TheSurfaceSpansTheSearchAndTheResult) {
  const Scanner scanner = ScannerOf(Scanned(40).placements, {{110.5, 395}, {130.5, 425}, 0.1});
  const Calibration c = Calibrated(scanner);
  const Start start = *scanner.FindStart();
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
  const Calibration c = Calibrated(ScannerOf(Scanned(40).placements, {{110, 395}, {115, 425}, 1}));
  const auto& near = c.surface.at("near").rows;
  EXPECT_GT(near.front()[0], 120);
}

TEST(TurntableFigures, WhatIsHeldHasOneNode) {
  Declaration declaration;
  declaration.search = {{110, 395}, {130, 425}, 1};
  Model model(Model::Residuals::kDepth);
  model.quantity(Model::kM).role = Role::kHold;
  model.quantity(Model::kM).value = 123;
  const Calibration c = Calibrated({declaration, model, Scanned(40).placements});
  EXPECT_EQ(c.surface.at("search").rows.size(), 31U);
  EXPECT_EQ(c.surface.at("near").rows.size(), 41U);
  EXPECT_EQ(c.surface.at("near").rows.front()[0], 123);
}

TEST(TurntableFigures, TheSceneStandsInTheTableFrame) {
  const ScannedPlates scene = Scanned(40);
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
    const System system{{c.Find("M")->value, c.Find("N")->value}, {}};
    EXPECT_NEAR((Eigen::Vector3d::Map(views[0].data()) - system.Point(-15 * kDegree, 0, 0)).norm(), 0, 1e-9);
    EXPECT_NEAR((Eigen::Vector3d::Map(views[8].data()) - system.Point(15 * kDegree, 0, 0)).norm(), 0, 1e-9);
  }
}

TEST(TurntableFigures, WhatWasDeclaredIsListed) {
  Declaration declaration;
  declaration.search = {{110, 395}, {130, 425}, 1};
  Model model(Model::Residuals::kDepth);
  model.quantity(Model::kScaleY).role = Role::kConsider;
  model.quantity(Model::kScaleY).u = 1e-4;
  model.quantity(Model::kM).u = 0.5;
  model.quantity(Model::kM).value = 122.9;
  const Calibration c = Calibrated({declaration, model, Scanned(40).placements});
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
    for (Placement& placement : Scanned(30).placements) many.push_back(placement);
  const std::vector<double> kSteps = {1, 0.1, 0.01};
  const Result<Comparison> few = ScannerOf(Scanned(30).placements).Compare({.steps = kSteps, .brief = true}),
                           all = ScannerOf(many).Compare({.steps = kSteps, .brief = true});
  ASSERT_TRUE(few.ok() && all.ok());
  constexpr size_t kHeldOut = 6;
  ASSERT_EQ(few->columns[kHeldOut].name, "held out/um");
  ASSERT_EQ(few->rows.size(), 10U);
  EXPECT_EQ(few->rows[1].note.english, "");  // step 0.1: 60,501 nodes
  EXPECT_THAT(few->rows[2].note, ::testing::HasSubstr("left out"));
  EXPECT_THAT(all->rows[1].note, ::testing::HasSubstr("left out"));  // of 48 placements
  EXPECT_TRUE(few->rows.back().cells[kHeldOut].value);
  EXPECT_FALSE(all->rows.back().cells[kHeldOut].value);  // 48 fits of 1440 profiles
  EXPECT_TRUE(all->rows[0].cells[kHeldOut].value);       // a grid has it for nothing
}

}  // namespace
}  // namespace scancal::turntable
