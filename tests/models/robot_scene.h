// A robot with a scanner and an artifact of eight balls, simulated in memory.
#pragma once
#include <glog/logging.h>
#include <Eigen/LU>
#include <numbers>
#include <vector>
#include "models/robot_ball/hand_eye.h"
#include "models/robot_ball/measured.h"
#include "solver/random.h"

namespace scancal {

constexpr double kDegree = std::numbers::pi / 180;

// A six-axis arm like a KUKA KR 10.
inline std::vector<Link> SixAxisArm() {
  return {{0, 400, 25, -90 * kDegree, 0}, {0, 0, 560, 0, 0},           {-90 * kDegree, 0, 35, -90 * kDegree, 0},
          {0, 515, 0, 90 * kDegree, 0},   {0, 0, 0, -90 * kDegree, 0}, {0, 90, 0, 0, 0}};
}

// Errors as Zhou et al. 2025 found them (Table 3), the angles read as degrees, without those that nothing can tell.
inline std::vector<Link> ArmErrors() {
  return {{0, 0, 0.1428, 0.0074 * kDegree, 0},
          {-0.0169 * kDegree, 0, -0.2632, 0.0022 * kDegree, 0.0079 * kDegree},
          {0.0309 * kDegree, -0.2168, 0.0508, -0.0127 * kDegree, 0},
          {-0.0407 * kDegree, 0.0687, 0.0268, 0.0014 * kDegree, 0},
          {0.0274 * kDegree, -0.0832, -0.0034, -0.0137 * kDegree, 0},
          {}};
}

inline std::vector<RobotBall::Sphere> EightSpheres() {
  return {{"A", {-500, 0, 0}},   {"B", {-350, 60, 20}}, {"C", {-200, -50, -25}}, {"D", {-60, 30, 40}},
          {"E", {80, -45, -10}}, {"F", {210, 55, 25}},  {"G", {360, -60, -20}},  {"H", {506, 10, 5}}};
}

namespace in_memory {

struct RobotScene {  // not that of models/robot_ball/simulate.h
  std::vector<Link> links = SixAxisArm();
  std::vector<Link> errors = std::vector<Link>(6);
  Eigen::Isometry3d flange_from_scanner = PoseOf({1.3, 0.6, 264.8, 0.01, 0.02, 1.55});
  int stations = 8, poses = 8;
  int balls = 8;                        // a pose sees
  double spread = 0.5;                  // rad, standard deviation of the joints within a station
  double noise = 0, repeatability = 0;  // mm, per axis
  uint64_t seed = 1;
};

}  // namespace in_memory

using in_memory::RobotScene;

inline RobotSetup Truth(const RobotScene& scene) { return {scene.flange_from_scanner, scene.errors}; }

inline std::vector<double> Near(const std::vector<double>& joints, double spread, Random& random) {
  std::vector<double> result = joints;
  for (double& q : result) q += spread * random.Normal();
  return result;
}

inline Eigen::Vector3d NormalVector(double sigma, Random& random) {
  const double x = random.Normal(), y = random.Normal(), z = random.Normal();
  return sigma * Eigen::Vector3d(x, y, z);
}

// A point of the base as the scanner sees it at the joints of the view.
inline Eigen::Vector3d SeenPoint(const RobotData& data, const RobotScene& scene, const RobotBall::View& view,
                                 const Eigen::Vector3d& p_in_base, Random& random) {
  return BaseFromScanner(data, Truth(scene), view).inverse() * p_in_base + NormalVector(scene.noise, random);
}

// What the scanner sees of the artifact at the joints: `balls` of them from the first on, cyclic.
inline RobotBall::View See(const RobotData& data, const RobotScene& scene, const Eigen::Isometry3d& base_from_artifact,
                           std::vector<double> joints, int first, Random& random) {
  RobotBall::View view{.name = "", .joints = std::move(joints)};
  const Eigen::Vector3d moved = NormalVector(scene.repeatability, random);
  for (int b = 0; b < scene.balls; ++b) {
    const int sphere = (first + b) % static_cast<int>(data.spheres.size());
    const Eigen::Vector3d in_base = base_from_artifact * data.spheres[sphere].centre - moved;
    view.balls.push_back({sphere, SeenPoint(data, scene, view, in_base, random)});
  }
  return view;
}

inline RobotData Simulate(const RobotScene& scene) {
  RobotData data;
  data.links = scene.links;
  data.spheres = EightSpheres();
  Random random(scene.seed, 0);
  for (int s = 0; s < scene.stations; ++s) {
    Station& station = data.stations.emplace_back();
    station.name = "S" + std::to_string(s + 1);
    const std::vector<double> home = Near({0, -1.2, 1.4, 0.2, 0.9, 0}, 0.4, random);
    RobotBall::View start{.name = "", .joints = home};
    const Eigen::Isometry3d ahead =
        Eigen::Translation3d(NormalVector(60, random) + Eigen::Vector3d(0, 0, 250)) *
        PoseOf((Eigen::Matrix<double, 6, 1>() << Eigen::Vector3d::Zero(), NormalVector(0.6, random)).finished());
    const Eigen::Isometry3d base_from_artifact = BaseFromScanner(data, Truth(scene), start) * ahead;
    for (int j = 0; j < scene.poses; ++j)
      station.views.push_back(
          See(data, scene, base_from_artifact, Near(home, scene.spread, random), 3 * j + s, random));
  }
  return data;
}

// Ten positions of a scale, its two balls seen from a pose each.
inline void AddCheck(const RobotScene& scene, RobotData* data) {
  Random random(scene.seed, 1);
  for (int k = 0; k < 10; ++k) {
    const std::vector<double> home = Near({0, -1.2, 1.4, 0.2, 0.9, 0}, 0.4, random);
    CheckLength check{"position " + std::to_string(k + 1), {}, {}, 299.546, 0.001};
    Eigen::Vector3d p_in_base =
        BaseFromScanner(*data, Truth(scene), {.name = "", .joints = home}) * Eigen::Vector3d(0, 0, 250);
    for (RobotBall::View* view : {&check.first_pose, &check.second_pose}) {
      view->joints = Near(home, scene.spread, random);
      const Eigen::Vector3d moved = NormalVector(scene.repeatability, random);
      view->balls.push_back({0, SeenPoint(*data, scene, *view, p_in_base - moved, random)});
      p_in_base += check.distance * NormalVector(1, random).normalized();
    }
    data->check.push_back(std::move(check));
  }
}

// One station seen from these poses of the flange, as a controller gives them.
inline RobotData SeenFrom(const std::vector<Eigen::Isometry3d>& flanges, const RobotScene& scene) {
  RobotData data;
  data.spheres = EightSpheres();
  data.stations.push_back({.name = "bench", .views = {}});
  Random random(scene.seed, 0);
  for (const Eigen::Isometry3d& flange : flanges) {
    RobotBall::View& view = data.stations[0].views.emplace_back();
    view.base_from_flange = flange;
    for (int b = 0; b < scene.balls; ++b) {
      const Eigen::Vector3d p_in_base = PoseOf({700, 50, 100, 0.3, -0.2, 2.0}) * data.spheres[b].centre;
      view.balls.push_back(
          {b, (flange * scene.flange_from_scanner).inverse() * p_in_base + NormalVector(scene.noise, random)});
    }
  }
  return data;
}

}  // namespace scancal
