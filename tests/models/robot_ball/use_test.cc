// Balls in the base of a calibrated robot.
#include "models/robot_ball/scanner.h"
#include "tests/models/robot_ball/files.h"

namespace scancal::robot_ball {
namespace {

using ::testing::HasSubstr;

class Kept final : public PointCloudWriter {
 public:
  Result<void> Write(std::span<const std::array<double, 3>> points_mm, int, std::span<const double>) override {
    for (const auto& p : points_mm) points.emplace_back(p[0], p[1], p[2]);
    return {};
  }
  Result<void> Commit() override { return {}; }
  std::vector<Eigen::Vector3d> points;
};

class RobotTransformTest : public RobotFilesTest {
 protected:
  // The true hand-eye, and links without errors.
  static Calibration Calibrated(size_t links) {
    Calibration calibration;
    const Model model(std::vector<Link>(links), {});
    for (const Quantity& quantity : model.quantities())
      if (quantity.scope == Scope::kSystem) calibration.parameters.emplace_back().name = quantity.name;
    for (int k = 0; k < 6; ++k) calibration.parameters[k].value = NumbersOf(HandEye())[k];
    return calibration;
  }
  std::string Transform(const Calibration& calibration) {
    EXPECT_TRUE(Declare().ok());
    const auto written = kKind.transform(*ReadDataset(folder_.path()), calibration, &cloud_);
    return written.ok() ? "" : written.error().message;
  }

  Kept cloud_;
};

TEST_F(RobotTransformTest, EveryBallIsWrittenInTheBase) {
  EXPECT_EQ(Transform(Calibrated(6)), "");
  ASSERT_EQ(cloud_.points.size(), kJoints.size() * kCentres.size());
  for (size_t k = 0; k < cloud_.points.size(); ++k)
    EXPECT_LT((cloud_.points[k] - BaseFromArtifact(k / kCentres.size()) * kCentres[k % kCentres.size()]).norm(), 1e-9);
}

TEST_F(RobotTransformTest, TheResultOfAnotherRobotIsRefused) {
  EXPECT_THAT(Transform(Calibrated(0)), HasSubstr("has no parameter theta_1"));  // of poses of the flange
  EXPECT_THAT(Transform(Calibrated(5)), HasSubstr("has no parameter theta_6"));
  EXPECT_THAT(Transform(Calibrated(7)), HasSubstr("more joints than the 6"));
  Calibration blind = Calibrated(6);
  blind.parameters.erase(blind.parameters.begin() + 2);
  EXPECT_THAT(Transform(blind), HasSubstr("has no parameter hand_eye_z"));
  UseFlangePoses();
  EXPECT_THAT(Transform(Calibrated(6)), HasSubstr("more joints than the 0"));
  EXPECT_EQ(Transform(Calibrated(0)), "");
}

}  // namespace
}  // namespace scancal::robot_ball
