// The hand-eye in closed form, and the artifact's poses.
#include "models/robot_ball/hand_eye.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include "models/robot_ball/virtual_point.h"
#include "tests/models/robot_scene.h"

namespace scancal {
namespace {

using testing::AllOf, testing::HasSubstr;

double Turn(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

void ExpectTruth(const RobotData& data, const RobotScene& scene, double mm, double rad) {
  const Result<RobotSetup> setup = InitialHandEye(data);
  ASSERT_TRUE(setup.ok()) << setup.error().message;
  EXPECT_LT(Turn(setup->flange_from_scanner, scene.flange_from_scanner), rad);
  EXPECT_LT((setup->flange_from_scanner.translation() - scene.flange_from_scanner.translation()).norm(), mm);
  EXPECT_EQ(setup->link_errors.size(), data.links.size());
}

std::string Complaint(const RobotData& data) {
  const Result<RobotSetup> setup = InitialHandEye(data);
  return setup.ok() ? "" : setup.error().message;
}

// The flange at joints, without links: the controller's poses.
RobotData WithoutLinks(RobotData data) {
  for (Station& station : data.stations)
    for (RobotBall::View& view : station.views) {
      view.base_from_flange = BaseFromFlange(data.links, view.joints);
      view.joints.clear();
    }
  data.links.clear();
  return data;
}

TEST(InitialHandEye, RecoversTheTruthFromNoiselessData) {
  RobotScene scene;
  ExpectTruth(Simulate(scene), scene, 1e-8, 1e-11);
  ExpectTruth(WithoutLinks(Simulate(scene)), scene, 1e-8, 1e-11);
}

TEST(InitialHandEye, FewPosesAndFewBallsSuffice) {
  RobotScene scene;
  scene.stations = 1;
  scene.poses = 3;
  ExpectTruth(Simulate(scene), scene, 1e-6, 1e-9);
  scene.balls = 3;
  scene.poses = 6;
  ExpectTruth(Simulate(scene), scene, 1e-6, 1e-9);
  scene.balls = 2;  // no pose knows the artifact's pose by itself
  scene.poses = 10;
  ExpectTruth(Simulate(scene), scene, 1e-6, 1e-9);
}

TEST(InitialHandEye, OneBallSuffices) {
  RobotScene scene;
  scene.stations = 1;
  scene.poses = 12;
  RobotData data = Simulate(scene);
  for (RobotBall::View& view : data.stations[0].views)
    std::erase_if(view.balls, [](const auto& ball) { return ball.sphere != 3; });
  ExpectTruth(data, scene, 1e-6, 1e-9);
}

TEST(InitialHandEye, AnyHandEye) {
  for (const double turn : {0.0, 1.0, 3.14159265358979, -2.5}) {
    RobotScene scene;
    scene.stations = 2;
    scene.flange_from_scanner = PoseOf({-150, 80, -20, 0.6 * turn, -0.8 * turn, 0});
    ExpectTruth(Simulate(scene), scene, 1e-7, 1e-10);
  }
}

TEST(InitialHandEye, LinkErrorsAndNoiseMoveItLittle) {
  RobotScene scene;
  scene.errors = ArmErrors();
  scene.noise = 0.035;
  scene.repeatability = 0.04;
  scene.balls = 4;
  ExpectTruth(Simulate(scene), scene, 2, 3e-3);
}

TEST(InitialHandEye, ATurnAboutAPointOfTheToolIsEnough) {
  const RobotScene scene;
  const Eigen::Vector3d tool(0, 0, 450), in_base(700, 50, 100);
  std::vector<Eigen::Isometry3d> flanges;
  for (const Eigen::Vector3d& turn : {Eigen::Vector3d(0, 0, 0), {0.4, 0, 0}, {0, 0.5, 0}, {0.2, -0.3, 0.4}}) {
    Eigen::Isometry3d& flange = flanges.emplace_back(PoseOf({0, 0, 0, turn[0], turn[1], turn[2]}));
    flange.translation() = in_base - flange.linear() * tool;
  }
  ExpectTruth(SeenFrom(flanges, scene), scene, 1e-7, 1e-10);
}

TEST(InitialHandEye, SaysThatPosesOnlyTranslate) {
  std::vector<Eigen::Isometry3d> flanges;
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(0, 0, 0), {80, 0, 0}, {0, 90, 0}, {0, 0, 70}, {-50, 20, 30}})
    flanges.push_back(PoseOf({at[0], at[1], at[2], 0.3, 2.8, 0.1}));
  EXPECT_THAT(Complaint(SeenFrom(flanges, {})), AllOf(HasSubstr("station bench"), HasSubstr("do not rotate")));
}

TEST(InitialHandEye, SaysThatPosesTurnAboutOneAxis) {
  std::vector<Eigen::Isometry3d> flanges;
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(0, 0, 0), {80, 0, 0}, {0, 90, 0}, {0, 0, 70}, {-50, 20, 30}})
    flanges.push_back(PoseOf({at[0], at[1], at[2], 0, at[1] / 200 + at[2] / 300, 0}));
  EXPECT_THAT(Complaint(SeenFrom(flanges, {})),
              AllOf(HasSubstr("station bench"), HasSubstr("one axis only"), HasSubstr("1.00, ")));
}

TEST(InitialHandEye, SaysThatPosesDoNotMove) {
  const Eigen::Isometry3d flange = PoseOf({400, 0, 500, 0.3, 2.8, 0.1});
  EXPECT_THAT(Complaint(SeenFrom({flange, flange, flange}, {})), HasSubstr("do not determine the turn"));
  EXPECT_THAT(Complaint(SeenFrom({flange}, {})), HasSubstr("station bench"));
  EXPECT_NE(Complaint(RobotData{}), "");
}

TEST(StationsAt, FindsTheArtifact) {
  const RobotScene scene;
  const Eigen::Isometry3d flange = PoseOf({400, 0, 500, 0.3, 2.8, 0.1});
  const auto stations = StationsAt(SeenFrom({flange}, scene), {scene.flange_from_scanner, {}});
  ASSERT_TRUE(stations.ok()) << stations.error().message;
  EXPECT_TRUE((*stations)[0].base_from_artifact.isApprox(PoseOf({700, 50, 100, 0.3, -0.2, 2.0}), 1e-12));
}

TEST(StationsAt, SaysWhichStationSeesALineOnly) {
  RobotScene scene;
  scene.balls = 2;
  scene.poses = 1;
  scene.stations = 1;
  const auto stations = StationsAt(Simulate(scene), Truth(scene));
  ASSERT_FALSE(stations.ok());
  EXPECT_THAT(stations.error().message, AllOf(HasSubstr("station S1"), HasSubstr("line")));
}

// Six moves of one orientation and six turns, as published.
std::vector<Eigen::Isometry3d> MovesAndTurns() {
  std::vector<Eigen::Isometry3d> flanges;
  for (const Eigen::Vector3d& at :
       {Eigen::Vector3d(0, 0, 0), {80, 0, 0}, {0, 90, 0}, {0, 0, 70}, {-50, 0, 0}, {0, -60, 0}})
    flanges.push_back(PoseOf({at[0], at[1], at[2], 0.3, 2.8, 0.1}));
  for (const Eigen::Vector3d& turn :
       {Eigen::Vector3d(0.3, 0, 0), {0, 0.3, 0}, {0, 0, 0.4}, {-0.3, 0.1, 0}, {0.1, -0.3, 0}, {0, 0.2, -0.3}})
    flanges.push_back(flanges[0] * PoseOf({50 * turn[1], 70 * turn[0], 30, turn[0], turn[1], turn[2]}));
  return flanges;
}

TEST(VirtualPointHandEye, RecoversTheTruthFromMovesAndTurns) {
  const RobotScene scene;
  const auto setup = VirtualPointHandEye(SeenFrom(MovesAndTurns(), scene));
  ASSERT_TRUE(setup.ok()) << setup.error().message;
  EXPECT_TRUE(setup->flange_from_scanner.isApprox(scene.flange_from_scanner, 1e-12));
}

TEST(VirtualPointHandEye, TheRotationIsOfTheMovesAndTheTranslationOfTheTurns) {
  const RobotScene scene;
  RobotData data = SeenFrom(MovesAndTurns(), scene);
  for (size_t k = 6; k < 12; ++k) data.stations[0].views[k].balls[0].centre.x() += 1 + static_cast<double>(k * k % 5);
  const auto setup = VirtualPointHandEye(data);
  ASSERT_TRUE(setup.ok()) << setup.error().message;
  EXPECT_LT(Turn(setup->flange_from_scanner, scene.flange_from_scanner), 1e-12);
  EXPECT_GT((setup->flange_from_scanner.translation() - scene.flange_from_scanner.translation()).norm(), 0.1);
}

TEST(VirtualPointHandEye, MovesInAPlaneSufficeMovesOnALineDoNot) {
  const RobotScene scene;
  std::vector<Eigen::Isometry3d> flanges = MovesAndTurns();
  flanges.erase(flanges.begin() + 3);  // the only one along z
  RobotData data = SeenFrom(flanges, scene);
  for (size_t k = 5; k < 11; ++k) data.stations[0].views[k].balls[0].centre.x() += 1 + static_cast<double>(k * k % 5);
  auto setup = VirtualPointHandEye(data);
  ASSERT_TRUE(setup.ok()) << setup.error().message;
  EXPECT_LT(Turn(setup->flange_from_scanner, scene.flange_from_scanner), 1e-12);  // of moves alone
  flanges.erase(flanges.begin() + 4);
  flanges.erase(flanges.begin() + 2);  // those along y
  setup = VirtualPointHandEye(SeenFrom(flanges, scene));
  ASSERT_TRUE(setup.ok()) << setup.error().message;
  EXPECT_TRUE(setup->flange_from_scanner.isApprox(scene.flange_from_scanner, 1e-10));  // in closed form, of all
}

TEST(VirtualPoints, AreOfTheSameBallsInAllPoses) {
  RobotScene scene;
  scene.balls = 7;
  scene.poses = 3;  // each misses another ball
  const RobotData data = Simulate(scene), points = VirtualPoints(data);
  for (const Station& station : points.stations) {
    ASSERT_EQ(station.views.size(), 3u);
    std::vector<Eigen::Vector3d> in_base;
    for (const RobotBall::View& view : station.views)
      in_base.push_back(BaseFromScanner(points, Truth(scene), view) * view.balls[0].centre);
    EXPECT_LT((in_base[0] - in_base[1]).norm() + (in_base[0] - in_base[2]).norm(), 1e-9);
  }
}

TEST(VirtualPoints, PosesWithoutACommonBallGo) {
  RobotScene scene;
  scene.stations = 1;
  scene.balls = 4;  // the poses see ABCD, DEFG, GHAB, BCDE, EFGH
  scene.poses = 5;
  const RobotData points = VirtualPoints(Simulate(scene));
  EXPECT_EQ(points.stations[0].views.size(), 3u);  // B is the first to be seen three times
}

}  // namespace
}  // namespace scancal
