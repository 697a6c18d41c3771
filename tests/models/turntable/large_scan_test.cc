// A scan too large to be held: what is told from profiles whose points are gone, against the same from the points.
#include <gtest/gtest.h>
#include <cmath>
#include "io/units.h"
#include "models/turntable/scanner.h"
#include "models/turntable/simulate.h"
#include "tests/io/temporary_folder.h"

namespace scancal::turntable {
namespace {

Scene SomeScene() {
  Scene scene;
  scene.placements = 3;
  scene.profiles = 120;
  scene.points = 200;
  scene.noise_y = 0.05;
  scene.outliers = 0.01;
  scene.encoder_jitter = 0.002 * kDegree;
  return scene;
}

// Of one placement; the first 15 profiles see a wall behind the plate.
std::vector<RawProfile> ProfilesOf(const SimulatedPlacement& placement) {
  std::vector<RawProfile> profiles;
  for (const SimulatedProfile& from : placement.profiles) {
    RawProfile& profile =
        profiles.emplace_back(RawProfile{static_cast<double>(profiles.size()), from.alpha, from.y, from.z, {}});
    for (double& y : profile.y) y += profiles.size() <= 15 ? 40 : 0;
  }
  return profiles;
}

RawScan Held(const SimulatedPlacement& placement) {
  RawScan scan;
  scan.name = placement.name;
  scan.profiles = ProfilesOf(placement);
  Clean(&scan);
  return scan;
}

RawScan Passing(const SimulatedPlacement& placement) {
  RawScan scan;
  scan.name = placement.name;
  scan.holds_points = false;
  const std::vector<RawProfile> all = ProfilesOf(placement);
  for (size_t first = 0; first < all.size(); first += 50) {
    const size_t last = std::min(first + 50, all.size());
    scan.profiles.assign(all.begin() + static_cast<std::ptrdiff_t>(first),
                         all.begin() + static_cast<std::ptrdiff_t>(last));
    Clean(&scan);
    EXPECT_TRUE(scan.profiles.empty());
  }
  return scan;
}

TEST(LargeScan, SetsAsideTheSame) {
  const Scene scene = SomeScene();
  for (const SimulatedPlacement& simulated : Simulate(scene)) {
    const RawScan held = Held(simulated), passing = Passing(simulated);
    EXPECT_NEAR(passing.off_line, held.off_line, 2);  // the least scale is that of the first fifty profiles
    const PointsOnPlane a = SetAsideOffPlane(held, scene.system), b = SetAsideOffPlane(passing, scene.system);
    EXPECT_GT(a.off, 15 * 190);
    EXPECT_NEAR(b.off, a.off, 5);
    ASSERT_EQ(a.compressed.size(), 105U);
    ASSERT_EQ(b.compressed.size(), 105U);
    Placement of_a = MakePlacement(held, a), of_b = MakePlacement(passing, b);
    EXPECT_NEAR(of_b.Points(), of_a.Points(), 5);
    EXPECT_NEAR(of_b.largest, 40 + of_a.largest, 41);  // the wall is among what was seen
    LookAtResiduals(held, a, &of_a);
    LookAtResiduals(passing, b, &of_b);
    EXPECT_NEAR(of_b.histogram.scale, of_a.histogram.scale, 0.02 * of_a.histogram.scale);
    const LineCorrelation line_a = Correlate(of_a.lag_sums), line_b = Correlate(of_b.lag_sums);
    EXPECT_NEAR(line_b.length, line_a.length, 0.05);
  }
}

// Profiles of which one end sees something else that lies on their line: a plate that bends away.
TEST(LargeScan, AnEighthOfAProfileMayBeOff) {
  Scene scene = SomeScene();
  scene.outliers = 0;
  std::vector<SimulatedPlacement> placements = Simulate(scene);
  RawScan scan;
  scan.holds_points = false;
  scan.profiles.clear();
  for (const SimulatedProfile& from : placements[0].profiles)
    scan.profiles.push_back({static_cast<double>(scan.profiles.size()), from.alpha, from.y, from.z, {}});
  for (size_t k = 0; k < 4; ++k) {  // tilted about one end by a millimetre over its length
    RawProfile& profile = scan.profiles[10 * k];
    for (size_t i = 0; i < profile.y.size(); ++i)
      profile.y[i] += 1.0 * static_cast<double>(i) / static_cast<double>(profile.y.size());
  }
  Clean(&scan);
  const PointsOnPlane left = SetAsideOffPlane(scan, scene.system);
  EXPECT_EQ(left.compressed.size(), scan.compressed.size());
  EXPECT_GT(left.off, 4 * 120);
  EXPECT_LT(left.off, 4 * 200);
}

TEST(LargeScan, IsReadWithoutHoldingItsPoints) {
  TemporaryFolder folder;
  Scene scene = SomeScene();
  scene.placements = 1;
  scene.profiles = 300;
  scene.points = 4000;
  ASSERT_TRUE(WriteSimulated(scene, ScanFileFormat::kNpy, folder.path()).ok());
  const auto dataset = ReadDataset(folder.path());
  ASSERT_TRUE(dataset.ok()) << dataset.error().message;
  Model model(Model::Residuals::kDepth);
  const auto declaration = Declare(*dataset, &model);
  ASSERT_TRUE(declaration.ok()) << declaration.error().message;
  const auto scan = ReadScan(declaration->scans[0], declaration->senses, [](double) {});
  ASSERT_TRUE(scan.ok()) << scan.error().message;
  EXPECT_FALSE(scan->holds_points);
  EXPECT_TRUE(scan->profiles.empty());
  ASSERT_EQ(scan->compressed.size(), 300U);
  double points = scan->off_line;
  for (size_t k = 0; k < scan->compressed.size(); ++k) {
    points += scan->compressed[k].count;
    const double before = k > 0 ? scan->compressed[k - 1].alpha : -10;
    EXPECT_GT(scan->compressed[k].alpha, before);  // in their order
  }
  EXPECT_EQ(points, 1'200'000);
}

}  // namespace
}  // namespace scancal::turntable
