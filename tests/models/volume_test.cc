#include "models/turntable/volume.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include "tests/models/calibrated_scene.h"

namespace scancal {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Volume, SpansWhatWasScanned) {
  TurntableScene scene = SmallScene();
  scene.noise_y = 0;
  const Calibration calibration = Calibrated(scene, ModelThatConsiders(kConsidered), NoErrors());
  const ScannedVolume volume = VolumeOf(calibration).value();
  double lowest = 1e9, highest = -1e9;
  for (const SimulatedPlacement& placement : SimulateTurntable(scene)) {
    for (const SimulatedProfile& profile : placement.profiles) {
      for (const double y : profile.y) {
        lowest = std::min(lowest, y);
        highest = std::max(highest, y);
      }
    }
  }
  EXPECT_NEAR(volume.alpha[0], -20 * kDegree, 1e-12);
  EXPECT_NEAR(volume.alpha[1], 20 * kDegree, 1e-12);
  // Eight points on a line: sqrt(9 / 7) of the length between the outermost.
  EXPECT_NEAR(volume.z[1], 100 * std::sqrt(9 / 7.0), 1e-9);
  EXPECT_NEAR(volume.z[0], -volume.z[1], 1e-9);
  const double line = 0.07 * (highest - lowest);
  EXPECT_NEAR(volume.y[0], lowest, line);
  EXPECT_NEAR(volume.y[1], highest, line);
  EXPECT_LE(volume.y[0], lowest);
  EXPECT_GE(volume.y[1], highest);
  EXPECT_THAT(volume.Beyond(0, 100, 0), IsEmpty());
  EXPECT_THAT(volume.Beyond(21 * kDegree, 1e4, 0), HasSubstr("alpha = 21 deg (scanned: -20 to 20 deg)"));
  EXPECT_THAT(volume.Beyond(0, 1e4, 0), HasSubstr("y = 1e+04 mm (scanned: "));
  EXPECT_THAT(volume.Beyond(0, 100, -150), HasSubstr("z = -150 mm (scanned: -113.4 to 113.4 mm)"));
}

TEST(Volume, HoldsWhatAPointThereWouldHave) {
  const Calibration calibration = Calibrated(SmallScene(), ModelThatConsiders(kConsidered), NoErrors());
  const PointUncertainty points = PointsOf(calibration);
  ASSERT_EQ(calibration.volume.rows.size(), 125u);
  EXPECT_EQ(calibration.volume.columns.size(), calibration.volume.units.size());
  for (const size_t i : {0, 31, 62, 124}) {
    const std::vector<double>& row = calibration.volume.rows[i];
    ASSERT_EQ(row.size(), calibration.volume.columns.size());
    const PropagatedPoint point = points.At(row[0], row[1], row[2]);
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(row[3 + k], point.position[k]);
      EXPECT_EQ(row[6 + k], point.uncertainty.U[k]);
      EXPECT_GE(row[9], row[6 + k]);
    }
    EXPECT_EQ(row[9], point.uncertainty.U_max);
  }
}

}  // namespace
}  // namespace scancal
