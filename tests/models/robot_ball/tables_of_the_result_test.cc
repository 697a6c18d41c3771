// The tables of a robot's result, against what they say ball by ball.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include "models/robot_ball/scanner.h"
#include "models/robot_ball/simulate.h"
#include "models/robot_ball/start.h"
#include "tests/models/robot_ball/without_links.h"
#include "tests/robot_study/declared.h"

namespace scancal::robot_ball {
namespace {

using ::testing::ElementsAre;

Scene SmallScene() {
  Scene scene;
  scene.stations = 4;
  return scene;
}

struct Calibrated {
  Measurements data;
  Calibration calibration;
  Kinematics setup;  // as the result says
};

Calibrated Calibrate(const Measurements& data) {
  Declaration declaration;
  declaration.data = data;
  declaration.u_of_spheres.resize(data.spheres.size(), 0.001);
  const Result<Calibration> result = Scanner(declaration, robot_study::DeclaredModel(data, SmallScene())).Calibrate({});
  EXPECT_TRUE(result.ok()) << result.error().message;
  if (!result.ok()) return {};
  Kinematics setup;
  setup.flange_from_scanner.matrix() = result->frames.at("hand_eye");
  for (size_t k = 1; k <= data.links.size(); ++k) {
    const auto value = [&](const char* name) { return result->Find(name + std::to_string(k))->value; };
    setup.link_errors.push_back({value("theta_"), value("d_"), value("a_"), value("alpha_"), value("beta_")});
  }
  return {data, *result, setup};
}

Eigen::Isometry3d BaseFromArtifact(const TargetSummary& target) {
  return PoseOf(Eigen::Matrix<double, 6, 1>::Map(target.geometry.at("base_from_artifact").data()));
}

Eigen::Vector3d At(const std::vector<double>& row, size_t first) { return Eigen::Vector3d::Map(row.data() + first); }

void ExpectTablesOf(const Calibrated& robot) {
  const size_t joints = robot.data.links.size();
  for (size_t t = 0; t < robot.data.stations.size(); ++t) {
    const TargetSummary& target = robot.calibration.targets[t];
    const Station& station = robot.data.stations[t];
    const NumberTable &poses = target.residual_tables.at("poses"), &balls = target.residual_tables.at("balls"),
                      &outline = target.scene.at("outline"), &views = target.scene.at("views");
    ASSERT_EQ(poses.rows.size(), station.views.size());
    ASSERT_EQ(views.rows.size(), station.views.size());
    ASSERT_EQ(outline.rows.size(), robot.data.spheres.size());
    for (size_t k = 0; k < outline.rows.size(); ++k) {
      EXPECT_EQ(outline.names[k], robot.data.spheres[k].name);
      EXPECT_LT((At(outline.rows[k], 0) - BaseFromArtifact(target) * robot.data.spheres[k].centre).norm(), 1e-6);
    }
    double squares = 0;
    size_t row = 0;
    for (size_t v = 0; v < station.views.size(); ++v) {
      const Model::View& view = station.views[v];
      const Eigen::Isometry3d base_from_scanner = BaseFromScanner(robot.data, robot.setup, view),
                              flange = base_from_scanner * robot.setup.flange_from_scanner.inverse();
      EXPECT_EQ(poses.names[v], view.name);
      EXPECT_EQ(views.names[v], view.name);
      ASSERT_EQ(poses.rows[v].size(), joints + 5);
      for (size_t q = 0; q < joints; ++q) EXPECT_EQ(poses.rows[v][q], view.joints[q]);
      EXPECT_LT((At(poses.rows[v], joints) - flange.translation()).norm(), 1e-6);
      EXPECT_EQ(poses.rows[v][joints + 3], static_cast<double>(view.balls.size()));
      EXPECT_LT((At(views.rows[v], 0) - base_from_scanner.translation()).norm(), 1e-6);
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      double of_pose = 0;
      for (const Model::SeenBall& ball : view.balls) {
        const Eigen::Vector3d& sphere = robot.data.spheres[ball.sphere].centre;
        const Eigen::Vector3d r = ball.centre - base_from_scanner.inverse() * (BaseFromArtifact(target) * sphere);
        EXPECT_EQ(balls.names[row], robot.data.spheres[ball.sphere].name);
        EXPECT_EQ(balls.rows[row][0], static_cast<double>(v));
        EXPECT_LT((At(balls.rows[row++], 1) - r).norm(), 1e-6);
        of_pose += r.squaredNorm();
        mean += ball.centre / static_cast<double>(view.balls.size());
      }
      EXPECT_NEAR(poses.rows[v].back(), std::sqrt(of_pose / 3 / static_cast<double>(view.balls.size())), 1e-6);
      EXPECT_LT((At(views.rows[v], 3) - base_from_scanner * mean).norm(), 1e-6);
      squares += of_pose;
    }
    ASSERT_EQ(row, balls.rows.size());
    EXPECT_NEAR(std::sqrt(squares / 3 / static_cast<double>(row)), target.rms, 1e-6);
  }
}

TEST(RobotFigures, TablesSayWhatTheResultSays) {
  const Calibrated robot = Calibrate(Simulate(SmallScene()).data);
  ExpectTablesOf(robot);
  EXPECT_THAT(robot.calibration.targets[0].residual_tables.at("poses").columns,
              ElementsAre("q1", "q2", "q3", "q4", "q5", "q6", "x", "y", "z", "balls", "rms"));
  EXPECT_EQ(robot.calibration.check.u, std::vector<double>(robot.data.check.size(), robot.data.check[0].u));
  EXPECT_GT(robot.data.check[0].u, 0);
}

TEST(RobotFigures, PosesOfTheFlangeHaveNoJoints) {
  const Calibrated robot = Calibrate(WithoutLinks(Simulate(SmallScene()).data));
  ExpectTablesOf(robot);
  EXPECT_THAT(robot.calibration.targets[0].residual_tables.at("poses").columns,
              ElementsAre("x", "y", "z", "balls", "rms"));
}

TEST(RobotFigures, ErrorsOfLinksKnowTheirNominalNumber) {
  const Calibrated robot = Calibrate(Simulate(SmallScene()).data);
  for (size_t k = 0; k < robot.data.links.size(); ++k) {
    const Link& link = robot.data.links[k];
    for (const auto& [name, nominal] : {std::pair{"theta_", link.theta},
                                        {"d_", link.d},
                                        {"a_", link.a},
                                        {"alpha_", link.alpha},
                                        {"beta_", link.beta}})
      EXPECT_EQ(robot.calibration.Find(name + std::to_string(k + 1))->nominal, nominal);
  }
  EXPECT_FALSE(robot.calibration.Find("hand_eye_x")->nominal);
}

}  // namespace
}  // namespace scancal::robot_ball
