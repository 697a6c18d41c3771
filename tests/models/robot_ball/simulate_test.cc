#include "models/robot_ball/simulate.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <memory>
#include <numbers>
#include "models/robot_ball/declare.h"
#include "models/robot_ball/fit.h"
#include "models/robot_ball/start.h"
#include "solver/model.h"
#include "tests/io/temporary_folder.h"

namespace scancal::robot_ball {
namespace {

Scene Noiseless() {
  Scene scene;
  scene.repeatability = scene.ball_noise = scene.u_spheres = 0;
  return scene;
}

// Largest residual of all poses at these hand-eye and link errors, the artifact where it truly is; mm.
double LargestResidual(const Simulated& robot, const Kinematics& setup) {
  const Model model(robot.data.links, robot.data.spheres);
  std::vector<double> q(model.quantities().size());
  Eigen::VectorXd::Map(&q[Model::kHandEye], 6) = NumbersOf(setup.flange_from_scanner);
  Eigen::VectorXd::Map(&q[Model::kLinks], kLinkNumbers * std::ssize(setup.link_errors)) = NumbersOf(setup.link_errors);
  double largest = 0;
  for (size_t s = 0; s < robot.data.stations.size(); ++s) {
    Station station = robot.data.stations[s];
    station.base_from_artifact = robot.base_from_artifact[s];
    for (const Model::View& view : station.views) {
      Eigen::VectorXd r(3 * model.Points(view));
      model.Residual(station, view, Seen<double>{q.data(), nullptr, 0}, r.data());
      largest = std::max(largest, r.cwiseAbs().maxCoeff());
    }
  }
  return largest;
}

TEST(Simulate, WithoutNoiseTheTruthExplainsEveryBall) {
  const Simulated robot = Simulate(Noiseless());
  EXPECT_LT(LargestResidual(robot, robot.truth), 1e-9);
  Kinematics nominal = robot.truth;
  nominal.link_errors.assign(6, {});
  EXPECT_GT(LargestResidual(robot, nominal), 0.5);
}

TEST(Simulate, SoDoesItInTheGaugeOfACalibration) {
  Simulated robot = Simulate(Noiseless());
  const Gauged gauged = InDefaultGauge(robot.data.links, robot.truth);
  for (Eigen::Isometry3d& pose : robot.base_from_artifact) pose = gauged.base_from_true_base * pose;
  EXPECT_LT(LargestResidual(robot, gauged.setup), 1e-9);
  const Model model(robot.data.links, robot.data.spheres);
  size_t k = Model::kLinks;
  for (const double x : NumbersOf(gauged.setup.link_errors))
    if (model.quantities()[k++].role == Role::kHold) {
      EXPECT_EQ(x, 0) << model.quantities()[k - 1].name;
    }
}

TEST(Simulate, IsTheExperimentOfThePaper) {
  const Simulated robot = Simulate({});
  const auto& spheres = robot.data.spheres;
  ASSERT_EQ(spheres.size(), 8);
  double longest = 0;
  for (const auto& a : spheres)
    for (const auto& b : spheres) longest = std::max(longest, (a.centre - b.centre).norm());
  EXPECT_NEAR(longest, 1006.863, 0.005);
  ASSERT_EQ(robot.data.stations.size(), 8);
  for (size_t s = 0; s < 8; ++s) {
    const auto& views = robot.data.stations[s].views;
    EXPECT_EQ(views.size(), s == 0 ? 14 : 8);
    for (const Model::View& view : views) EXPECT_GE(view.balls.size(), 4);
  }
  EXPECT_EQ(robot.data.check.size(), 10);
}

TEST(Simulate, FirstPosesOnlyTranslate) {
  for (const auto configuration :
       {PoseConfiguration::kSpatial, PoseConfiguration::kPlanar, PoseConfiguration::kCollinear}) {
    Scene scene;
    scene.configuration = configuration;
    scene.translations = 12;
    const Simulated robot = Simulate(scene);
    const auto& views = robot.data.stations[0].views;
    const Eigen::Isometry3d first = BaseFromFlange(robot.data.links, views[0].joints);
    for (int k = 1; k <= 12; ++k) {
      EXPECT_EQ(views[k].balls.size(), 4);
      const Eigen::Isometry3d pose = BaseFromFlange(robot.data.links, views[k].joints);
      EXPECT_LT((pose.linear() - first.linear()).norm(), 1e-12);
      EXPECT_GT((pose.translation() - first.translation()).norm(), 0.9);
    }
    const Eigen::Isometry3d other = BaseFromFlange(robot.data.links, views[13].joints);
    EXPECT_GT((other.linear() - first.linear()).norm(), 0.1);
  }
}

TEST(Simulate, NoiseMovesNoPoseAndStationsDoNotMoveEachOther) {
  Scene scene;
  const Simulated one = Simulate(scene);
  scene.noise_seed = 2;
  scene.stations = 3;
  const Simulated other = Simulate(scene);
  ASSERT_EQ(other.data.stations.size(), 3);
  for (size_t s = 0; s < 3; ++s) {
    const auto &a = one.data.stations[s].views, &b = other.data.stations[s].views;
    ASSERT_EQ(a.size(), b.size());
    for (size_t k = 0; k < a.size(); ++k) {
      EXPECT_EQ(a[k].joints, b[k].joints);
      EXPECT_NE(a[k].balls[0].centre, b[k].balls[0].centre);
    }
  }
}

// Balls of a pose share the flange's error; what is left of each is its own. Standard errors from 3 x 4000 numbers.
TEST(Simulate, NoiseIsAsDeclared) {
  Scene scene = Noiseless();
  scene.stations = 500;
  scene.translations = scene.check_positions = 0;
  const Simulated exact = Simulate(scene);
  scene.repeatability = 0.04;
  scene.ball_noise = 0.035;
  const Simulated noisy = Simulate(scene);
  double common = 0, own = 0, poses = 0, balls = 0;
  for (size_t s = 0; s < exact.data.stations.size(); ++s) {
    for (size_t k = 0; k < exact.data.stations[s].views.size(); ++k) {
      const auto &a = exact.data.stations[s].views[k].balls, &b = noisy.data.stations[s].views[k].balls;
      if (a.size() != 4 || b.size() != 4) continue;
      Eigen::Matrix<double, 3, 4> error;
      for (int i = 0; i < 4; ++i) error.col(i) = b[i].centre - a[i].centre;
      const Eigen::Vector3d mean = error.rowwise().mean();
      common += mean.squaredNorm();
      own += (error.colwise() - mean).squaredNorm();
      poses += 3;
      balls += 9;
    }
  }
  ASSERT_EQ(poses, 3 * 4000);
  const double variance = 0.035 * 0.035, of_mean = 0.04 * 0.04 + variance / 4;
  EXPECT_NEAR(own / balls, variance, 4 * variance * std::sqrt(2 / balls));
  EXPECT_NEAR(common / poses, of_mean, 4 * of_mean * std::sqrt(2 / poses));
}

TEST(Simulate, ScaleIsItsLengthApart) {
  const Simulated robot = Simulate(Noiseless());
  const auto in_base = [&](const Model::View& view) -> Eigen::Vector3d {
    return BaseFromScanner(robot.data, robot.truth, view) * view.balls.at(0).centre;
  };
  for (const CheckLength& check : robot.data.check) {
    EXPECT_NEAR((in_base(check.first_pose) - in_base(check.second_pose)).norm(), kScaleLength, 1e-9);
    EXPECT_EQ(check.distance, kScaleLength);
  }
}

void ExpectSame(const Model::View& a, const Model::View& b) {
  EXPECT_EQ(a.name, b.name);
  ASSERT_EQ(a.joints.size(), b.joints.size());
  for (size_t k = 0; k < a.joints.size(); ++k) EXPECT_NEAR(a.joints[k], b.joints[k], 1e-11);
  ASSERT_EQ(a.balls.size(), b.balls.size());
  for (size_t k = 0; k < a.balls.size(); ++k) EXPECT_LT((a.balls[k].centre - b.balls[k].centre).norm(), 1e-6);
}

TEST(WriteSimulated, IsReadBackAsItWas) {
  Scene scene;
  scene.stations = 3;
  const TemporaryFolder folder;
  const Result<void> written = WriteSimulated(scene, true, folder.path());
  ASSERT_TRUE(written.ok()) << written.error().message;
  const Result<Dataset> dataset = ReadDataset(folder.path());
  ASSERT_TRUE(dataset.ok()) << dataset.error().message;
  const Result<Declaration> read = Declare(*dataset);
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_THAT(read->warnings, testing::IsEmpty());
  const Measurements data = Simulate(scene).data;
  ASSERT_EQ(read->data.links.size(), data.links.size());
  for (size_t k = 0; k < data.links.size(); ++k) {
    const Link &a = read->data.links[k], &b = data.links[k];
    EXPECT_NEAR(a.theta, b.theta, 1e-14);
    EXPECT_EQ(a.d, b.d);
    EXPECT_EQ(a.a, b.a);
    EXPECT_NEAR(a.alpha, b.alpha, 1e-14);
    EXPECT_EQ(a.beta, b.beta);
  }
  ASSERT_EQ(read->data.spheres.size(), data.spheres.size());
  for (size_t k = 0; k < data.spheres.size(); ++k) {
    EXPECT_EQ(read->data.spheres[k].name, data.spheres[k].name);
    EXPECT_LT((read->data.spheres[k].centre - data.spheres[k].centre).norm(), 1e-6);
  }
  EXPECT_NEAR(read->data.u_spheres, data.u_spheres, 1e-12);
  EXPECT_EQ(read->data.ball_diameter, data.ball_diameter);
  EXPECT_EQ(read->data.usual_ball_noise, data.usual_ball_noise);
  ASSERT_EQ(read->data.stations.size(), data.stations.size());
  for (size_t s = 0; s < data.stations.size(); ++s) {
    EXPECT_EQ(read->data.stations[s].name, data.stations[s].name);
    ASSERT_EQ(read->data.stations[s].views.size(), data.stations[s].views.size());
    for (size_t k = 0; k < data.stations[s].views.size(); ++k)
      ExpectSame(read->data.stations[s].views[k], data.stations[s].views[k]);
  }
  ASSERT_EQ(read->data.check.size(), data.check.size());
  for (size_t k = 0; k < data.check.size(); ++k) {
    EXPECT_NEAR(read->data.check[k].distance, data.check[k].distance, 1e-6);
    EXPECT_EQ(read->data.check[k].u, data.check[k].u);
    ExpectSame(read->data.check[k].first_pose, data.check[k].first_pose);
    ExpectSame(read->data.check[k].second_pose, data.check[k].second_pose);
  }
}

TEST(WriteSimulated, RefusesWhatCannotBe) {
  const TemporaryFolder folder;
  Scene scene;
  scene.poses = 0;
  EXPECT_THAT(WriteSimulated(scene, false, folder.path()).error().message, testing::HasSubstr("stations and poses"));
  scene = {};
  scene.repeatability = -1;
  EXPECT_THAT(WriteSimulated(scene, false, folder.path()).error().message, testing::HasSubstr("repeatability"));
}

TEST(InverseKinematics, ReachesToRoundingOrSaysNo) {
  const std::vector<double> joints = {0.3, -1.2, 0.1, 0.4, 0.9, -0.7}, start = {0.1, -1.0, 0.2, 0.2, 0.7, -0.5};
  const Eigen::Isometry3d there = BaseFromFlange(Kr10Links(), joints);
  const auto found = JointsFor(Kr10Links(), there, start);
  ASSERT_TRUE(found);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR((*found)[i], joints[i], 1e-13);
  EXPECT_FALSE(JointsFor(Kr10Links(), Eigen::Translation3d(3000, 0, 0) * there, start));
}

}  // namespace
}  // namespace scancal::robot_ball
