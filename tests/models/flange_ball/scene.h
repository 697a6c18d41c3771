// A simulated robot that puts the ball on its flange into the sockets of a tool.
#pragma once
#include <gtest/gtest.h>
#include <numbers>
#include <vector>
#include "models/flange_ball/scanner.h"
#include "solver/dense.h"
#include "solver/random.h"

namespace scancal::flange_ball {

struct Scene {
  Robot truth;
  std::vector<Link> nominal;
  std::vector<Model::Target> tools;
};

struct SceneChoice {
  int tools = 3, poses = 10;  // poses in each socket
  double spacing = 50;        // mm
  double seat = 0.1;          // noise, mm
  double joints = 0;          // noise, rad
  uint64_t seed = 1;
  Eigen::Vector3d ball = {60, 30, 120};  // far from the last axis
};

// A Panda, as its maker draws it.
inline std::vector<Link> NominalPanda() {
  constexpr double kQuarter = std::numbers::pi / 2;
  return {{0, 333, 0, -kQuarter},
          {0, 0, 0, kQuarter},
          {0, 316, 82.5, kQuarter},
          {0, 0, -82.5, -kQuarter},
          {0, 384, 0, kQuarter},
          {0, 0, 88, kQuarter},
          {0, 107, 0, 0}};
}

// Joint angles near `joints` with the ball at p, by Newton's steps of least norm.
inline std::vector<double> Reach(const Robot& robot, std::vector<double> joints, const Eigen::Vector3d& p) {
  for (int step = 0; step < 50; ++step) {
    const Eigen::Vector3d apart = p - robot.InBase({joints});
    if (apart.norm() < 1e-11) break;
    Eigen::MatrixXd jacobian(3, joints.size());  // axis x (ball - axis)
    std::vector<Link> before;
    std::vector<double> angles;
    for (size_t k = 0; k < joints.size(); ++k) {
      const Eigen::Isometry3d axis = BaseFromFlange(before, angles);
      jacobian.col(static_cast<Eigen::Index>(k)) = axis.linear().col(2).cross(p - apart - axis.translation());
      before.push_back(robot.links[k]);
      angles.push_back(joints[k]);
    }
    const Eigen::VectorXd turn = LeastSquares(jacobian, apart);
    const double length = std::min(1.0, 0.3 / turn.norm());
    for (size_t k = 0; k < joints.size(); ++k) joints[k] += length * turn[static_cast<Eigen::Index>(k)];
  }
  EXPECT_LT((p - robot.InBase({joints})).norm(), 1e-9);
  return joints;
}

// Link errors of some 0.5 mm and 5 mrad in what is estimated by default, the same for every seed.
inline Robot TrueRobot(const Eigen::Vector3d& ball) {
  Robot robot{NominalPanda(), ball};
  Model model(robot.links);
  Random random(7, 0);
  Eigen::VectorXd numbers = NumbersOf(robot.links);
  for (Eigen::Index k = 0; k < numbers.size(); ++k) {
    const Quantity& quantity = model.quantities()[Model::kLinks + k];
    const double size = quantity.unit == Unit::kMm ? 0.5 : 5e-3;
    if (quantity.role == Role::kEstimate) numbers[k] += size * random.Normal();
  }
  robot.links = LinksOf(numbers);
  return robot;
}

// Without noise; the same for every seed.
inline Scene CleanScene(const SceneChoice& choice) {
  Scene scene{TrueRobot(choice.ball), NominalPanda(), {}};
  Random random(3, 0);
  for (int t = 0; t < choice.tools; ++t) {
    Model::Target& tool = scene.tools.emplace_back();
    tool.name = "tool" + std::to_string(t + 1);
    const double around = 2.0 * t - 2, heading = 1.3 * t;
    const Eigen::Vector3d socket(500 * std::cos(around), 500 * std::sin(around), 150 + 120 * t);
    Model::SetDirection({std::cos(heading), std::sin(heading), 0.3 * t}, &tool);
    for (const int s : {0, 1}) {
      for (int pose = 0; pose < choice.poses; ++pose) {
        std::vector<double> joints = {around, 0.3, 0, -1.9, 0, 2.2, 0.8};
        for (double& angle : joints) angle += 0.6 * random.Normal();
        tool.views.push_back({Reach(scene.truth, joints, socket + s * choice.spacing * tool.direction), s});
      }
    }
  }
  return scene;
}

inline Scene MakeScene(const SceneChoice& choice) {
  Scene scene = CleanScene(choice);
  Random random(choice.seed, 1);
  for (Model::Target& tool : scene.tools) {
    for (Model::View& view : tool.views) {
      Eigen::Vector3d seat = scene.truth.InBase(view);
      for (int i = 0; i < 3; ++i) seat[i] += choice.seat * random.Normal();
      view.joints = Reach(scene.truth, view.joints, seat);
      for (double& angle : view.joints) angle += choice.joints * random.Normal();
    }
  }
  return scene;
}

// Of the model's estimated system quantities: what was simulated.
inline Eigen::VectorXd TruthOf(const Scene& scene, const Model& model) {
  std::vector<double> truth;
  for (int k = 0; k < model.FirstOfJoints(); ++k) {
    const Quantity& quantity = model.quantities()[k];
    if (quantity.scope != Scope::kSystem || quantity.role != Role::kEstimate) continue;
    if (k < Model::kSpacing) {
      truth.push_back(scene.truth.ball[k]);
    } else {
      truth.push_back((NumbersOf(scene.truth.links) - NumbersOf(scene.nominal))[k - Model::kLinks]);
    }
  }
  return Eigen::VectorXd::Map(truth.data(), std::ssize(truth));
}

}  // namespace scancal::flange_ball
