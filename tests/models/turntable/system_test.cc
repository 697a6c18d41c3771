// Whatever is wrong with the system, all that is computed from it speaks of the same system: simulation, search,
// comparison, verdicts, points and clouds.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include "io/units.h"
#include "models/models.h"
#include "models/turntable/scanner.h"
#include "models/turntable/simulate.h"
#include "tests/io/temporary_folder.h"

namespace scancal::turntable {
namespace {

constexpr double kNoise_mm = 0.01;

// A linearity of 1 mm would bend the single lines visibly, too; the model knows it as the straight line that it looks
// like in each profile (AddBend).
struct Wrong {
  Model::Index index;
  double error;  // mm, rad, 1: without it the planes are bent by much more than the noise, or M and N are moved
};

class SystemTest : public ::testing::TestWithParam<Wrong> {
 protected:
  SystemTest() {
    scene_.profiles = 40;
    scene_.points = 30;
    scene_.sweep = 40 * kDegree;
    scene_.noise_y = kNoise_mm;
    scene_.system[GetParam().index] = GetParam().error;
    truth_ = WithDepths(scene_);
  }

  // role: "{{hold: {}}}", filled with the true error in units of the data set.
  Dataset Simulated(const std::string& role) {
    const Quantity quantity = Model(Model::Residuals::kDepth).quantities()[GetParam().index];
    const double error = GetParam().error / (quantity.unit == Unit::kRad ? kDegree : 1);
    EXPECT_TRUE(WriteSimulated(scene_, ScanFileFormat::kNpy, folder_.path()).ok());
    folder_.Write("dataset.yaml", folder_.Read("dataset.yaml") + "parameters: {" + quantity.name + ": " +
                                      fmt::format(fmt::runtime(role), error) + "}\n");
    return *ReadDataset(folder_.path());
  }

  void ExpectTruth(const Calibration& result) const {
    EXPECT_TRUE(result.ok()) << result.unreliable.front();
    EXPECT_NEAR(result.Find("M")->value, truth_.M(), 4 * result.Find("M")->u);
    EXPECT_NEAR(result.Find("N")->value, truth_.N(), 4 * result.Find("N")->u);
  }

  static void ExpectFlat(const ComparisonRow& row) {
    constexpr size_t kRms_um = 5, kHeldOut_um = 6;
    ASSERT_FALSE(row.cells.empty()) << row.method << row.note;
    EXPECT_NEAR(row.cells[kRms_um].value.value_or(-1), 1000 * kNoise_mm, 200 * kNoise_mm) << row.method;
    if (row.cells[kHeldOut_um].value) {
      EXPECT_LT(*row.cells[kHeldOut_um].value, 1500 * kNoise_mm) << row.method;
    }
  }

  Scene scene_;
  System truth_;
  TemporaryFolder folder_;
};

TEST_P(SystemTest, IsTheSameEverywhereWhereItIsKnown) {
  const Dataset dataset = Simulated("{{hold: {:.17g}}}");
  const auto scanner = Load(dataset);
  ASSERT_TRUE(scanner.ok()) << scanner.error().message;
  const Result<Calibration> result = (*scanner)->Calibrate({});
  ASSERT_TRUE(result.ok()) << result.error().message;
  ExpectTruth(*result);
  for (const TargetSummary& target : result->targets) EXPECT_EQ(target.set_aside.size(), 0U);

  // The search sees flat planes at the result, and nowhere better ones.
  const auto &near = result->surface.at("near").rows, &search = result->surface.at("search").rows;
  const double S = near[near.size() / 2][2];
  EXPECT_NEAR(S, kNoise_mm, 0.2 * kNoise_mm);
  const auto by_S = [](const auto& a, const auto& b) { return a[2] < b[2]; };
  EXPECT_LT(S, (*std::min_element(search.begin(), search.end(), by_S))[2] * 1.001);
  EXPECT_NEAR(result->grid.at[0], truth_.M(), 1);
  EXPECT_NEAR(result->grid.at[1], truth_.N(), 1);
  const auto comparison = (*scanner)->Compare({.brief = true});
  ASSERT_TRUE(comparison.ok());
  for (const ComparisonRow& row : comparison->rows)
    if (row.method.english.starts_with("joint") && row.note.empty()) ExpectFlat(row);
  ExpectFlat(comparison->rows.back());

  // A point of the result is where the true system has it, as far as M and N are known.
  const auto propagation = Propagate(*result, {"-15,60,-80", {}, {}}, false);
  ASSERT_TRUE(propagation.ok()) << propagation.error().message;
  const PropagatedPoint& point = propagation->points[0];
  EXPECT_LT((point.position - truth_.Point(-15 * kDegree, 60, -80)).norm(), 3 * point.uncertainty.U_max);

  // So is the cloud of all points: it lies on the planes that the scene was made of.
  const std::filesystem::path file = folder_.path() / "cloud.csv";
  auto cloud = CreatePointCloud(file);
  ASSERT_TRUE(cloud.ok());
  ASSERT_TRUE(Transform(dataset, *result, cloud->get()).ok() && (*cloud)->Commit().ok());
  std::istringstream lines(folder_.Read("cloud.csv"));
  std::string line;
  std::getline(lines, line);
  const std::vector<SimulatedPlacement> placements = Simulate(scene_);
  double squares = 0, points = 0;
  while (std::getline(lines, line)) {
    double x = 0, y = 0, z = 0;
    int scan = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%d", &x, &y, &z, &scan), 4) << line;
    const SimulatedPlacement& placement = placements.at(static_cast<size_t>(scan));
    squares += std::pow(placement.normal.dot(Eigen::Vector3d(x, y, z)) - placement.distance, 2);
    ++points;
  }
  EXPECT_EQ(points, 3 * scene_.profiles * scene_.points);
  EXPECT_NEAR(std::sqrt(squares / points), kNoise_mm, 0.3 * kNoise_mm);
}

TEST_P(SystemTest, IsJudgedByWhatWasFound) {
  const auto scanner = Load(Simulated("{{estimate: 0, u: {:.17g}}}"));
  ASSERT_TRUE(scanner.ok()) << scanner.error().message;
  const Result<Calibration> result = (*scanner)->Calibrate({});
  ASSERT_TRUE(result.ok()) << result.error().message;
  ExpectTruth(*result);
  EXPECT_NEAR(result->sigma, kNoise_mm, 0.1 * kNoise_mm);
  const auto& near = result->surface.at("near").rows;
  EXPECT_NEAR(near[near.size() / 2][2], kNoise_mm, 0.2 * kNoise_mm);
  const auto comparison = (*scanner)->Compare({.brief = true});
  ASSERT_TRUE(comparison.ok());
  ExpectFlat(comparison->rows.back());
}

INSTANTIATE_TEST_SUITE_P(
    , SystemTest,
    ::testing::Values(Wrong{Model::kTiltX, 0.02}, Wrong{Model::kTiltY, 0.02}, Wrong{Model::kScaleY, 0.005},
                      Wrong{Model::kScaleZ, 0.02}, Wrong{Model::kShear, 0.02}, Wrong{Model::kLinearity, 0.2},
                      Wrong{Model::kEncoderCos1, 0.3 * kDegree}, Wrong{Model::kEncoderSin1, 0.3 * kDegree},
                      Wrong{Model::kEncoderCos2, 0.3 * kDegree}, Wrong{Model::kEncoderSin2, 0.3 * kDegree},
                      Wrong{Model::kExpansion, 0.002}),
    [](const auto& wrong) { return Model(Model::Residuals::kDepth).quantities()[wrong.param.index].name; });

}  // namespace
}  // namespace scancal::turntable
