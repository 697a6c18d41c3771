// A robot's data set on disk: two stations of a few poses of a six-joint arm, exact centres of five balls.
#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <functional>
#include <map>
#include <string>
#include <vector>
#include "io/units.h"
#include "models/robot_ball/declare.h"
#include "tests/io/temporary_folder.h"

namespace scancal::robot_ball {

class RobotFilesTest : public ::testing::Test {
 protected:
  RobotFilesTest() {
    poses_ = {"station,pose,q1,q2,q3,q4,q5,q6"};
    balls_ = {"pose,ball,x,y,z"};
    artifact_ = {"ball,x,y,z"};
    for (size_t k = 0; k < kCentres.size(); ++k)
      artifact_.push_back(kNames[k] + "," + Numbers({kCentres[k][0], kCentres[k][1], kCentres[k][2]}));
    for (size_t p = 0; p < kJoints.size(); ++p) {
      const std::string pose = "P" + std::to_string(p + 1);
      poses_.push_back((p < 3 ? "left," : "right,") + pose + "," + Numbers(kJoints[p]));
      for (size_t k = 0; k < kCentres.size(); ++k) balls_.push_back(Row(pose, k, Seen(p, k)));
    }
  }

  static std::string Numbers(const std::vector<double>& numbers) {
    std::string text;
    for (const double number : numbers) {
      char buffer[32];
      std::snprintf(buffer, sizeof buffer, "%s%.17g", text.empty() ? "" : ",", number);
      text += buffer;
    }
    return text;
  }
  static std::string Row(const std::string& pose, size_t ball, const Eigen::Vector3d& p) {
    return pose + "," + kNames[ball] + "," + Numbers({p[0], p[1], p[2]});
  }
  static std::vector<Link> Links() {
    const double quarter = 90 * kDegree;
    return {{0, 400, 25, -quarter, 0}, {0, 0, 560, 0, 0},      {0, 0, 35, -quarter, 0},
            {0, 515, 0, quarter, 0},   {0, 0, 0, -quarter, 0}, {0, 80, 0, 0, 0}};
  }
  static Eigen::Isometry3d Flange(size_t pose) {
    std::vector<double> joints = kJoints[pose];
    for (double& q : joints) q *= kDegree;
    return BaseFromFlange(Links(), joints);
  }
  static Eigen::Isometry3d HandEye() { return PoseOf({30, -20, 150, 0.1, -0.2, 1.5}); }
  static Eigen::Isometry3d BaseFromArtifact(size_t pose) {
    return pose < 3 ? PoseOf({900, 100, 200, 0.2, 0.1, -0.4}) : PoseOf({600, -500, 300, 0, 0.3, 1});
  }
  static Eigen::Vector3d Seen(size_t pose, size_t ball) {
    return (Flange(pose) * HandEye()).inverse() * (BaseFromArtifact(pose) * kCentres[ball]);
  }

  static std::string Text(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return text;
  }
  Result<Declaration> Declare() const {
    folder_.Write("dataset.yaml", top_ + robot_ + rest_ + more_);
    folder_.Write("poses.csv", Text(poses_));
    folder_.Write("balls.csv", Text(balls_));
    folder_.Write("artifact.csv", Text(artifact_));
    SCANCAL_ASSIGN_OR_RETURN(const Dataset dataset, ReadDataset(folder_.path()));
    return robot_ball::Declare(dataset);
  }
  Declaration Declared() const {
    auto declaration = Declare();
    EXPECT_TRUE(declaration.ok()) << declaration.error().message;
    return declaration.ok() ? *std::move(declaration) : Declaration{};
  }
  std::string Error() const {
    const auto declaration = Declare();
    return declaration.ok() ? "" : declaration.error().message;
  }
  Model ModelWith(const std::string& lines) {
    more_ = lines;
    const auto model = DeclareModel(Declared());
    EXPECT_TRUE(model.ok()) << model.error().message;
    return model.ok() ? *model : Model({}, {});
  }
  std::string ModelError(const std::string& lines) {
    more_ = lines;
    const auto declaration = Declare();
    if (!declaration.ok()) return declaration.error().message;
    const auto model = DeclareModel(*declaration);
    return model.ok() ? "" : model.error().message;
  }
  // Poses of the flange in place of joint angles.
  void UseFlangePoses() {
    robot_.clear();
    poses_ = {"station,pose,x,y,z,qx,qy,qz,qw"};
    for (size_t p = 0; p < kJoints.size(); ++p) {
      const Eigen::Isometry3d flange = Flange(p);
      const Eigen::Quaterniond turn(flange.linear());
      const Eigen::Vector3d t = flange.translation();
      poses_.push_back((p < 3 ? "left,P" : "right,P") + std::to_string(p + 1) + "," +
                       Numbers({t[0], t[1], t[2], turn.x(), turn.y(), turn.z(), turn.w()}));
    }
  }

  static inline const std::vector<std::string> kNames = {"A", "B", "C", "D", "E"};
  static inline const std::vector<Eigen::Vector3d> kCentres = {
      {0, 0, 0}, {200, 10, 0}, {30, 150, 20}, {120, 90, 60}, {-70, 110, -40}};
  static inline const std::vector<std::vector<double>> kJoints = {
      {10, -80, 95, 5, 40, 20},   {-15, -60, 80, 30, 55, -40},  {25, -95, 110, -25, 30, 70},
      {-40, -70, 90, 15, 50, 10}, {-60, -85, 100, -10, 35, 60}, {-30, -50, 70, 40, 65, -30}};

  TemporaryFolder folder_;
  std::string top_ = "scancal: 1\nmodel: robot-ball\nunits: {length: mm, angle: deg}\n";
  std::string robot_ =
      "robot:\n  links:\n    - {theta: 0, d: 400, a: 25, alpha: -90, beta: 0}\n    - {d: 0, a: 560, alpha: 0}\n"
      "    - {d: 0, a: 35, alpha: -90}\n    - {d: 515, a: 0, alpha: 90}\n    - {d: 0, a: 0, alpha: -90}\n"
      "    - {d: 80, a: 0, alpha: 0}\n";
  std::string rest_ = "poses: poses.csv\nobservations: balls.csv\nartifact: artifact.csv\n";
  std::string more_;
  std::vector<std::string> poses_, balls_, artifact_;
};

}  // namespace scancal::robot_ball
