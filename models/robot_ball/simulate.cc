#include "models/robot_ball/simulate.h"
#include <glog/logging.h>
#include <cmath>
#include "io/units.h"
#include "models/robot_ball/hand_eye.h"
#include "models/robot_ball/pose_planner.h"

namespace scancal {
namespace {

constexpr double kBallDiameter = 12.70;  // mm
// Poses of the stations have the streams 1, 2, ... of the seed, what is measured there those of the noise seed.
constexpr uint64_t kArtifactStream = uint64_t{1} << 32, kScaleStream = uint64_t{2} << 32,
                   kCheckStreams = uint64_t{3} << 32;
constexpr int kEnd = 4;  // balls of an end of the artifact

PoseSpread SpreadOf(PoseConfiguration configuration) {
  const Eigen::Vector3d turn = Eigen::Vector3d(30, 30, 60) * kDegree, shift = {10, 10, 15};
  switch (configuration) {
    case PoseConfiguration::kSpatial:
      return {turn, shift};
    case PoseConfiguration::kPlanar:
      return {turn.cwiseProduct(Eigen::Vector3d(0.1, 1, 0.1)), shift};
    case PoseConfiguration::kCollinear:
      return {turn.cwiseProduct(Eigen::Vector3d(0.1, 0.1, 1)), shift};
  }
  LOG(FATAL) << "no such configuration";
}

// Along the axes of the base, one after the other there and back.
Eigen::Vector3d Translation(PoseConfiguration configuration, int k) {
  constexpr double kFar = 20, kNear = 2;  // mm
  const int axis = k % 3;
  const bool is_far =
      configuration == PoseConfiguration::kSpatial || axis < (configuration == PoseConfiguration::kPlanar ? 2 : 1);
  const double part = 1.0 / (1 + k / 6);  // NOLINT(bugprone-integer-division): six directions, then again but shorter
  return (k / 3 % 2 == 0 ? part : -part) * (is_far ? kFar : kNear) * Eigen::Vector3d::Unit(axis);
}

// Z towards the robot and upwards, X along Y of the base: how things to be seen lie before the robot, more or less.
Eigen::Isometry3d DrawPlace(Random* random) {
  const double lean = 45 * kDegree + 25 * kDegree * (2 * random->Uniform() - 1);
  const double yaw = 25 * kDegree * (2 * random->Uniform() - 1), roll = 15 * kDegree * (2 * random->Uniform() - 1);
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.translation() = Eigen::Vector3d(620, 0, 350) + DrawWithin({60, 60, 300}, random);
  Eigen::Matrix3d straight;
  straight << 0, -1, 0,  //
      1, 0, 0,           //
      0, 0, 1;
  place.linear() =
      (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()) *
       Eigen::AngleAxisd(-lean, Eigen::Vector3d::UnitY()))
          .toRotationMatrix() *
      straight;
  return place;
}

class Simulation {
 public:
  explicit Simulation(const RobotScene& scene)
      : scene_(scene), planner_(scene.links, scene.flange_from_scanner), spheres_(PublishedArtifact()) {
    data_.links = scene.links;
    truth_ = {scene.flange_from_scanner, scene.link_errors};
  }
  SimulatedRobot Run() const;

 private:
  struct PlannedStation {
    Eigen::Isometry3d base_from_artifact;
    std::vector<std::vector<double>> joints;
  };
  std::vector<RobotBall::Sphere> MeasuredSpheres() const;
  PlannedStation PlanStation(int number) const;
  bool TryStation(bool first, Random* random, PlannedStation* station) const;
  RobotBall::View See(const std::vector<double>& joints, const Eigen::Isometry3d& base_from_artifact,
                      const std::vector<RobotBall::Sphere>& spheres, Random* noise) const;
  Station MeasureStation(int number, const PlannedStation& planned) const;
  CheckLength Check(int number) const;

  const RobotScene& scene_;
  PosePlanner planner_;
  std::vector<RobotBall::Sphere> spheres_;  // truth
  RobotData data_;                          // nominal links
  RobotSetup truth_;
};

std::vector<RobotBall::Sphere> Simulation::MeasuredSpheres() const {
  Random noise(scene_.noise_seed, kArtifactStream);
  std::vector<RobotBall::Sphere> measured = spheres_;
  for (RobotBall::Sphere& sphere : measured)
    for (double& x : sphere.centre) x += scene_.u_spheres * noise.Normal();
  return measured;
}

bool Simulation::TryStation(bool first, Random* random, PlannedStation* station) const {
  station->base_from_artifact = DrawPlace(random);
  station->joints.clear();
  const PoseSpread spread = SpreadOf(scene_.configuration);
  for (int k = 0; k < scene_.poses; ++k) {
    Eigen::Vector3d aim = Eigen::Vector3d::Zero();
    for (int b = 0; b < kEnd; ++b) aim += spheres_[k % 2 * kEnd + b].centre / kEnd;
    const Eigen::Isometry3d straight = station->base_from_artifact * Eigen::Translation3d(aim);
    const int translations = first && k == 0 ? scene_.translations : 0;
    std::vector<std::vector<double>> joints;
    for (int tries = 0; joints.size() < static_cast<size_t>(1 + translations); ++tries) {
      constexpr int kTries = 20;
      if (tries == kTries) return false;
      const Eigen::Isometry3d base_from_scanner = DrawPose(straight, spread, random);
      joints = {planner_.Joints(base_from_scanner, random)};
      for (int t = 0; t < translations && !joints.back().empty(); ++t)
        joints.push_back(
            planner_.Joints(Eigen::Translation3d(Translation(scene_.configuration, t)) * base_from_scanner, random));
      if (joints.back().empty()) joints.clear();
    }
    station->joints.insert(station->joints.end(), joints.begin(), joints.end());
  }
  return true;
}

Simulation::PlannedStation Simulation::PlanStation(int number) const {
  constexpr int kTries = 1000;
  Random random(scene_.seed, static_cast<uint64_t>(number) + 1);
  PlannedStation station;
  for (int tries = 0; !TryStation(number == 0, &random, &station); ++tries)
    CHECK_LT(tries, kTries) << "the robot reaches no place for the artifact";
  return station;
}

RobotBall::View Simulation::See(const std::vector<double>& joints, const Eigen::Isometry3d& base_from_artifact,
                                const std::vector<RobotBall::Sphere>& spheres, Random* noise) const {
  RobotBall::View view{.name = "", .joints = joints};
  Eigen::Isometry3d base_from_scanner = BaseFromScanner(data_, truth_, view);
  for (double& x : base_from_scanner.translation()) x += scene_.repeatability * noise->Normal();
  const Eigen::Isometry3d scanner_from_artifact = base_from_scanner.inverse() * base_from_artifact;
  for (size_t b = 0; b < spheres.size(); ++b) {
    Eigen::Vector3d centre = scanner_from_artifact * spheres[b].centre;
    const bool is_seen = centre.norm() <= scene_.field;
    for (double& x : centre) x += scene_.ball_noise * noise->Normal();
    if (is_seen) view.balls.push_back({static_cast<int>(b), centre});
  }
  return view;
}

Station Simulation::MeasureStation(int number, const PlannedStation& planned) const {
  Random noise(scene_.noise_seed, static_cast<uint64_t>(number) + 1);
  Station station;
  station.name = std::to_string(number + 1);
  for (const std::vector<double>& joints : planned.joints) {
    station.views.push_back(See(joints, planned.base_from_artifact, spheres_, &noise));
    station.views.back().name = station.name + "-" + std::to_string(station.views.size());
  }
  return station;
}

CheckLength Simulation::Check(int number) const {
  Random random(scene_.seed, kCheckStreams + number), noise(scene_.noise_seed, kCheckStreams + number);
  const PoseSpread spread = SpreadOf(PoseConfiguration::kSpatial);
  CheckLength check;
  check.name = std::to_string(number + 1);
  check.distance = kScaleLength + scene_.u_spheres * Random(scene_.noise_seed, kScaleStream).Normal();
  check.u = scene_.u_spheres;
  while (true) {
    const Eigen::Isometry3d place = DrawPlace(&random);
    std::vector<RobotBall::View> views;
    for (const double half : {-kScaleLength / 2, kScaleLength / 2}) {
      const RobotBall::Sphere ball{"", {half, 0, 0}};
      const Eigen::Isometry3d straight = place * Eigen::Translation3d(ball.centre);
      const std::vector<double> joints = planner_.Joints(DrawPose(straight, spread, &random), &random);
      if (joints.empty()) break;
      views.push_back(See(joints, place, {ball}, &noise));
      views.back().name = check.name + (half < 0 ? "-a" : "-b");
    }
    if (views.size() < 2) continue;
    check.first_pose = views[0];
    check.second_pose = views[1];
    return check;
  }
}

SimulatedRobot Simulation::Run() const {
  SimulatedRobot robot{data_, truth_, {}};
  robot.data.spheres = MeasuredSpheres();
  robot.data.u_spheres = scene_.u_spheres;
  robot.data.ball_diameter = kBallDiameter;
  robot.data.usual_ball_noise = scene_.ball_noise;
  for (int k = 0; k < scene_.stations; ++k) {
    const PlannedStation planned = PlanStation(k);
    robot.data.stations.push_back(MeasureStation(k, planned));
    robot.base_from_artifact.push_back(planned.base_from_artifact);
  }
  for (int k = 0; k < scene_.check_positions; ++k) robot.data.check.push_back(Check(k));
  return robot;
}

}  // namespace

std::vector<RobotBall::Sphere> PublishedArtifact() {
  constexpr double kLongest = 1006.863;
  const Eigen::Vector3d first(-503, 18, 6);
  const double along = std::sqrt(kLongest * kLongest - 34 * 34 - 2 * 2);
  const std::vector<Eigen::Vector3d> centres = {
      first,         {-468, -26, 30}, {-436, 22, -4}, {-421, -20, 12},
      {424, 21, 10}, {441, -24, -6},  {471, 25, 28},  first + Eigen::Vector3d(along, -34, -2)};
  std::vector<RobotBall::Sphere> spheres;
  for (const Eigen::Vector3d& centre : centres) spheres.push_back({std::to_string(spheres.size() + 1), centre});
  return spheres;
}

SimulatedRobot SimulateRobot(const RobotScene& scene) { return Simulation(scene).Run(); }

}  // namespace scancal
