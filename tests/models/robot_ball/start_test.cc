// The hand-eye in closed form, and the artifact's poses.
#include "models/robot_ball/start.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include "models/robot_ball/published.h"
#include "models/robot_ball/simulate.h"
#include "tests/models/robot_ball/without_links.h"

namespace scancal::robot_ball {
namespace {

using testing::AllOf, testing::HasSubstr;

double Turn(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

void ExpectTruth(const Measurements& data, double mm, double rad) {
  const Result<Kinematics> setup = InitialHandEye(data);
  ASSERT_TRUE(setup.ok()) << setup.error().message;
  EXPECT_LT(Turn(setup->flange_from_scanner, PublishedHandEye()), rad);
  EXPECT_LT((setup->flange_from_scanner.translation() - PublishedHandEye().translation()).norm(), mm);
  EXPECT_EQ(setup->link_errors.size(), data.links.size());
}

std::string Complaint(const Measurements& data) {
  const Result<Kinematics> setup = InitialHandEye(data);
  return setup.ok() ? "" : setup.error().message;
}

// One station seen from these poses of the flange, as a controller gives them.
Measurements SeenFrom(const std::vector<Eigen::Isometry3d>& flanges) {
  Measurements data;
  data.spheres = PublishedArtifact();
  data.stations.push_back({.name = "bench", .views = {}});
  for (const Eigen::Isometry3d& flange : flanges) {
    Model::View& view = data.stations[0].views.emplace_back();
    view.base_from_flange = flange;
    for (int b = 0; b < std::ssize(data.spheres); ++b)
      view.balls.push_back({b, (flange * PublishedHandEye()).inverse() *
                                   (PoseOf({700, 50, 100, 0.3, -0.2, 2.0}) * data.spheres[b].centre)});
  }
  return data;
}

// A nominal robot without noise: poses at each station that see all balls.
Scene Exact(int stations, int poses) {
  Scene scene;
  scene.link_errors.assign(6, {});
  scene.repeatability = scene.ball_noise = scene.u_spheres = 0;
  scene.stations = stations;
  scene.poses = poses;
  scene.translations = 0;
  scene.field = 1e6;
  return scene;
}

// Each pose keeps so many of its balls, not the same.
Measurements Fewer(Measurements data, int balls) {
  for (Station& station : data.stations)
    for (size_t j = 0; j < station.views.size(); ++j) {
      auto& seen = station.views[j].balls;
      std::rotate(seen.begin(), seen.begin() + static_cast<int>(3 * j % seen.size()), seen.end());
      seen.resize(balls);
    }
  return data;
}

TEST(InitialHandEye, RecoversTheTruthFromNoiselessData) {
  Scene scene = Exact(8, 8);
  ExpectTruth(Simulate(scene).data, 1e-8, 1e-11);
  ExpectTruth(WithoutLinks(Simulate(scene).data), 1e-8, 1e-11);
  scene.field = 80;  // an end of the artifact
  ExpectTruth(Simulate(scene).data, 1e-8, 1e-11);
}

TEST(InitialHandEye, FewPosesAndFewBallsSuffice) {
  ExpectTruth(Simulate(Exact(1, 3)).data, 1e-6, 1e-9);
  ExpectTruth(Fewer(Simulate(Exact(1, 6)).data, 3), 1e-6, 1e-9);
  ExpectTruth(Fewer(Simulate(Exact(1, 12)).data, 2), 1e-6, 1e-9);  // no pose knows the artifact's by itself
}

TEST(InitialHandEye, OneBallSuffices) {
  for (const int poses : {5, 12}) {  // five give eight equations for the turn, as many as are needed
    Measurements data = Simulate(Exact(1, poses)).data;
    for (Model::View& view : data.stations[0].views)
      std::erase_if(view.balls, [](const auto& ball) { return ball.sphere != 3; });
    ExpectTruth(data, 1e-6, 1e-9);
  }
}

TEST(InitialHandEye, AnyHandEye) {
  for (const double turn : {0.0, 1.0, 3.14159265358979, -2.5}) {
    const Eigen::Isometry3d other = PoseOf({-150, 80, -20, 0.6 * turn, -0.8 * turn, 0});
    Measurements data = Simulate(Exact(2, 8)).data;
    for (Station& station : data.stations)
      for (Model::View& view : station.views)
        for (auto& ball : view.balls) ball.centre = other.inverse() * (PublishedHandEye() * ball.centre);
    const Result<Kinematics> setup = InitialHandEye(data);
    ASSERT_TRUE(setup.ok()) << setup.error().message;
    EXPECT_TRUE(setup->flange_from_scanner.isApprox(other, 1e-9)) << turn;
  }
}

TEST(InitialHandEye, LinkErrorsAndNoiseMoveItLittle) {
  for (const uint64_t seed : {1, 2, 3}) {
    Scene scene;  // as published
    scene.seed = scene.noise_seed = seed;
    ExpectTruth(Simulate(scene).data, 2, 3e-3);
  }
}

TEST(InitialHandEye, ATurnAboutAPointOfTheToolIsEnough) {
  const Eigen::Vector3d tool(0, 0, 450), in_base(700, 50, 100);
  std::vector<Eigen::Isometry3d> flanges;
  for (const Eigen::Vector3d& turn : {Eigen::Vector3d(0, 0, 0), {0.4, 0, 0}, {0, 0.5, 0}, {0.2, -0.3, 0.4}}) {
    Eigen::Isometry3d& flange = flanges.emplace_back(PoseOf({0, 0, 0, turn[0], turn[1], turn[2]}));
    flange.translation() = in_base - flange.linear() * tool;
  }
  ExpectTruth(SeenFrom(flanges), 1e-7, 1e-10);
}

TEST(InitialHandEye, SaysThatPosesOnlyTranslate) {
  std::vector<Eigen::Isometry3d> flanges;
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(0, 0, 0), {80, 0, 0}, {0, 90, 0}, {0, 0, 70}, {-50, 20, 30}})
    flanges.push_back(PoseOf({at[0], at[1], at[2], 0.3, 2.8, 0.1}));
  EXPECT_THAT(Complaint(SeenFrom(flanges)), AllOf(HasSubstr("station bench"), HasSubstr("do not rotate")));
}

TEST(InitialHandEye, SaysThatPosesTurnAboutOneAxis) {
  std::vector<Eigen::Isometry3d> flanges;
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(0, 0, 0), {80, 0, 0}, {0, 90, 0}, {0, 0, 70}, {-50, 20, 30}})
    flanges.push_back(PoseOf({at[0], at[1], at[2], 0, at[1] / 200 + at[2] / 300, 0}));
  EXPECT_THAT(Complaint(SeenFrom(flanges)),
              AllOf(HasSubstr("station bench"), HasSubstr("one axis only"), HasSubstr("1.00, ")));
}

TEST(InitialHandEye, SaysThatPosesDoNotMove) {
  const Eigen::Isometry3d flange = PoseOf({400, 0, 500, 0.3, 2.8, 0.1});
  EXPECT_THAT(Complaint(SeenFrom({flange, flange, flange})), HasSubstr("do not determine the turn"));
  EXPECT_THAT(Complaint(SeenFrom({flange})), HasSubstr("station bench"));
  EXPECT_NE(Complaint(Measurements{}), "");
}

TEST(StationsAt, FindsTheArtifact) {
  const Eigen::Isometry3d flange = PoseOf({400, 0, 500, 0.3, 2.8, 0.1});
  const auto stations = StationsAt(SeenFrom({flange}), {PublishedHandEye(), {}});
  ASSERT_TRUE(stations.ok()) << stations.error().message;
  EXPECT_TRUE((*stations)[0].base_from_artifact.isApprox(PoseOf({700, 50, 100, 0.3, -0.2, 2.0}), 1e-12));
}

TEST(StationsAt, SaysWhichStationSeesALineOnly) {
  const Simulated robot = Simulate(Exact(1, 1));
  const auto stations = StationsAt(Fewer(robot.data, 2), robot.truth);
  ASSERT_FALSE(stations.ok());
  EXPECT_THAT(stations.error().message, AllOf(HasSubstr("station 1"), HasSubstr("line")));
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
  const auto setup = VirtualPointHandEye(SeenFrom(MovesAndTurns()));
  ASSERT_TRUE(setup.ok()) << setup.error().message;
  EXPECT_TRUE(setup->flange_from_scanner.isApprox(PublishedHandEye(), 1e-12));
}

TEST(VirtualPointHandEye, TheRotationIsOfTheMovesAndTheTranslationOfTheTurns) {
  Measurements data = SeenFrom(MovesAndTurns());
  for (size_t k = 6; k < 12; ++k) data.stations[0].views[k].balls[0].centre.x() += 1 + static_cast<double>(k * k % 5);
  const auto setup = VirtualPointHandEye(data);
  ASSERT_TRUE(setup.ok()) << setup.error().message;
  EXPECT_LT(Turn(setup->flange_from_scanner, PublishedHandEye()), 1e-12);
  EXPECT_GT((setup->flange_from_scanner.translation() - PublishedHandEye().translation()).norm(), 0.1);
}

TEST(VirtualPointHandEye, MovesInAPlaneSufficeMovesOnALineDoNot) {
  std::vector<Eigen::Isometry3d> flanges = MovesAndTurns();
  flanges.erase(flanges.begin() + 3);  // the only one along z
  Measurements data = SeenFrom(flanges);
  for (size_t k = 5; k < 11; ++k) data.stations[0].views[k].balls[0].centre.x() += 1 + static_cast<double>(k * k % 5);
  auto setup = VirtualPointHandEye(data);
  ASSERT_TRUE(setup.ok()) << setup.error().message;
  EXPECT_LT(Turn(setup->flange_from_scanner, PublishedHandEye()), 1e-12);  // of moves alone
  flanges.erase(flanges.begin() + 4);
  flanges.erase(flanges.begin() + 2);  // those along y
  setup = VirtualPointHandEye(SeenFrom(flanges));
  ASSERT_TRUE(setup.ok()) << setup.error().message;
  EXPECT_TRUE(setup->flange_from_scanner.isApprox(PublishedHandEye(), 1e-10));  // in closed form, of all
}

TEST(VirtualPointHandEye, TakesThePlannedTranslationsOfASimulatedRobot) {
  Scene scene = Exact(3, 8);
  scene.translations = 6;
  scene.field = 80;
  const auto setup = VirtualPointHandEye(Simulate(scene).data);
  ASSERT_TRUE(setup.ok()) << setup.error().message;
  EXPECT_LT(Turn(setup->flange_from_scanner, PublishedHandEye()), 1e-6);  // joint angles are planned to no better
  EXPECT_LT((setup->flange_from_scanner.translation() - PublishedHandEye().translation()).norm(), 1e-4);
}

TEST(VirtualPoints, StandStillAtEachStation) {
  const Simulated robot = Simulate(Exact(2, 3));
  const Measurements points = VirtualPoints(Fewer(robot.data, 7));  // each pose misses another ball
  ASSERT_EQ(points.stations.size(), 2u);
  for (const Station& station : points.stations) {
    ASSERT_EQ(station.views.size(), 3u);
    std::vector<Eigen::Vector3d> in_base;
    for (const Model::View& view : station.views)
      in_base.push_back(BaseFromScanner(points, robot.truth, view) * view.balls[0].centre);
    EXPECT_LT((in_base[0] - in_base[1]).norm() + (in_base[0] - in_base[2]).norm(), 1e-9);
  }
}

TEST(VirtualPoints, PosesWithoutACommonBallHaveSeveral) {
  const Measurements data = Fewer(Simulate(Exact(1, 5)).data, 4);  // of balls 1 to 8: 1234, 4567, 7812, 2345, 5678
  std::vector<size_t> poses;
  for (const Station& station : VirtualPoints(data).stations) poses.push_back(station.views.size());
  EXPECT_THAT(poses, testing::ElementsAre(3, 2));  // those that see 2, then those that see 5
}

}  // namespace
}  // namespace scancal::robot_ball
