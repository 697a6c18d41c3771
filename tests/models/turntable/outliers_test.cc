// What points off the plate cost: nothing by more than u, and little of u, see docs/uncertainty.md, section 5.
#include <gtest/gtest.h>
#include "models/turntable/scanner.h"
#include "models/turntable/simulate.h"
#include "tests/io/temporary_folder.h"

namespace scancal::turntable {
namespace {

constexpr int kSeeds = 20;

// Of M and N over the seeds: mean u, mean error, and the mean square of error / u.
struct Share {
  double u[2] = {0, 0}, bias[2] = {0, 0}, scatter[2] = {0, 0}, set_aside = 0;
  double StandardError(int k) const { return std::sqrt(scatter[k] / kSeeds); }
};

class OutliersTest : public ::testing::Test {
 protected:
  // Written, read and calibrated as the program does it.
  Calibration Calibrated(const Scene& scene) {
    const auto written = WriteSimulated(scene, ScanFileFormat::kNpy, folder_.path());
    EXPECT_TRUE(written.ok()) << written.error().message;
    const auto dataset = ReadDataset(folder_.path());
    EXPECT_TRUE(dataset.ok()) << dataset.error().message;
    const auto scanner = Load(*dataset);
    EXPECT_TRUE(scanner.ok()) << scanner.error().message;
    const auto calibration = (*scanner)->Calibrate({});
    EXPECT_TRUE(calibration.ok()) << calibration.error().message;
    return *calibration;
  }

  Share Repeat(double outliers, double background) {
    Share study;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      Scene scene;
      scene.profiles = 20;
      scene.points = 60;
      scene.outliers = outliers;
      scene.background = background;
      scene.seed = static_cast<uint64_t>(seed);
      const Calibration result = Calibrated(scene);
      for (int k = 0; k < 2; ++k) {
        const Parameter& p = *result.Find(k == 0 ? "M" : "N");
        const double error = p.value - (k == 0 ? scene.system.M() : scene.system.N());
        study.u[k] += p.u / kSeeds;
        study.bias[k] += error / kSeeds;
        study.scatter[k] += error * error / kSeeds;
      }
      for (const TargetSummary& target : result.targets)
        for (const auto& [reason, count] : target.set_aside) study.set_aside += count / kSeeds;
    }
    return study;
  }

  TemporaryFolder folder_;
};

TEST_F(OutliersTest, TwoPercentSpikesCostLessThanFivePercentOfU) {
  const Share clean = Repeat(0, 0), spiked = Repeat(0.02, 0);
  EXPECT_LT(clean.set_aside, 1);
  EXPECT_NEAR(spiked.set_aside, 72, 4 * std::sqrt(72.0 / kSeeds));
  for (int k = 0; k < 2; ++k) {
    EXPECT_LT(spiked.u[k] / clean.u[k], 1.05);
    EXPECT_GT(spiked.u[k] / clean.u[k], 0.99);
    EXPECT_LT(std::abs(spiked.bias[k]), 3 * spiked.StandardError(k));
  }
}

TEST_F(OutliersTest, ThirtyPercentBackgroundLeavesNoBias) {  // what it moves: see tests/cli/background_test.cc
  const Share study = Repeat(0, 0.3);
  EXPECT_NEAR(study.set_aside, 0.3 * 3600, 5);
  for (int k = 0; k < 2; ++k) {
    EXPECT_LT(std::abs(study.bias[k]), 3 * study.StandardError(k));
    EXPECT_NEAR(std::sqrt(study.scatter[k]) / study.u[k], 1, 4 / std::sqrt(2.0 * kSeeds));
  }
}

}  // namespace
}  // namespace scancal::turntable
