// What a robot's data set may say, and what comes of it.
#include "tests/models/robot_files.h"

namespace scancal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class RobotDeclarationTest : public RobotFilesTest {};

// Every residual of exact data vanishes at the truth.
void ExpectExact(const RobotDeclaration& declaration, const Eigen::Isometry3d& hand_eye,
                 const std::function<Eigen::Isometry3d(size_t)>& base_from_artifact) {
  const auto model = DeclareModel(declaration);
  ASSERT_TRUE(model.ok()) << model.error().message;
  size_t pose = 0, balls = 0;
  for (Station station : declaration.data.stations) {
    station.base_from_artifact = base_from_artifact(pose);
    for (const RobotBall::View& view : station.views) {
      const Eigen::Isometry3d flange =
          declaration.data.links.empty() ? view.base_from_flange : BaseFromFlange(declaration.data.links, view.joints);
      for (const RobotBall::SeenBall& ball : view.balls) {
        const Eigen::Vector3d in_base =
            station.base_from_artifact * declaration.data.spheres[static_cast<size_t>(ball.sphere)].centre;
        EXPECT_LT((flange * hand_eye * ball.centre - in_base).norm(), 1e-9) << view.name;
        ++balls;
      }
      ++pose;
    }
  }
  EXPECT_EQ(pose, 6U);
  EXPECT_EQ(balls, 30U);
}

TEST_F(RobotDeclarationTest, JointAnglesAndCentres) {
  const RobotDeclaration declaration = Declared();
  EXPECT_THAT(declaration.warnings, IsEmpty());
  ASSERT_EQ(declaration.data.links.size(), 6U);
  EXPECT_NEAR(declaration.data.links[0].alpha, -90 * kDegree, 1e-15);
  ASSERT_EQ(declaration.data.stations.size(), 2U);
  EXPECT_EQ(declaration.data.stations[1].name, "right");
  EXPECT_EQ(declaration.data.stations[1].views[0].name, "P4");
  EXPECT_EQ(declaration.data.usual_ball_noise, 0);
  EXPECT_THAT(declaration.files, ElementsAre(folder_.path() / "dataset.yaml", folder_.path() / "poses.csv",
                                             folder_.path() / "balls.csv", folder_.path() / "artifact.csv"));
  ExpectExact(declaration, HandEye(), BaseFromArtifact);
}

TEST_F(RobotDeclarationTest, FlangePosesNeedNoLinks) {
  UseFlangePoses();
  const RobotDeclaration declaration = Declared();
  EXPECT_THAT(declaration.data.links, IsEmpty());
  ExpectExact(declaration, HandEye(), BaseFromArtifact);
}

}  // namespace
}  // namespace scancal
