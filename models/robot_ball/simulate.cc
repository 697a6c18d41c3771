#include "models/robot_ball/simulate.h"
#include <fmt/format.h>
#include <glog/logging.h>
#include <cmath>
#include <span>
#include "io/json_file.h"
#include "io/output_file.h"
#include "io/units.h"
#include "models/robot_ball/fit.h"
#include "models/robot_ball/start.h"

namespace scancal::robot_ball {
namespace {

constexpr double kBallDiameter = 12.70;  // mm
// Poses of the stations have the streams 1, 2, ... of the seed, what is measured there those of the noise seed.
constexpr uint64_t kArtifactStream = uint64_t{1} << 32, kScaleStream = uint64_t{2} << 32,
                   kCheckStreams = uint64_t{3} << 32;
constexpr int kEnd = 4;  // balls of an end of the artifact

// How far a pose may differ from looking straight, each drawn uniformly from -limit to limit; mm, rad.
struct PoseSpread {
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();   // about the scanner's axes
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // along them
};

Eigen::Vector3d DrawWithin(const Eigen::Vector3d& limit, Random* random) {
  Eigen::Vector3d drawn;
  for (int i = 0; i < 3; ++i) drawn[i] = limit[i] * (2 * random->Uniform() - 1);
  return drawn;
}

Eigen::Isometry3d DrawPose(const Eigen::Isometry3d& straight, const PoseSpread& spread, Random* random) {
  const Eigen::Vector3d turn = DrawWithin(spread.turn, random), shift = DrawWithin(spread.shift, random);
  return straight * Eigen::Translation3d(shift) * Eigen::AngleAxisd(turn.x(), Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(turn.y(), Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(turn.z(), Eigen::Vector3d::UnitZ());
}

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
  explicit Simulation(const Scene& scene) : scene_(scene), spheres_(PublishedArtifact()) {
    data_.links = scene.links;
    truth_ = {scene.flange_from_scanner, scene.link_errors, scene.joint_terms};
  }
  Simulated Run() const;

 private:
  struct PlannedStation {
    Eigen::Isometry3d base_from_artifact;
    std::vector<std::vector<double>> joints;
  };
  std::vector<Model::Sphere> MeasuredSpheres() const;
  // That bring the scanner there, or none.
  std::vector<double> Joints(const Eigen::Isometry3d& base_from_scanner, Random* random) const {
    return PlanJoints(scene_.links, base_from_scanner * scene_.flange_from_scanner.inverse(), random);
  }
  PlannedStation PlanStation(int number) const;
  bool TryStation(bool first, Random* random, PlannedStation* station) const;
  // terms: JointTermsAt of the pose.
  Model::View See(const std::vector<double>& joints, const std::vector<double>& terms,
                  const Eigen::Isometry3d& base_from_artifact, const std::vector<Model::Sphere>& spheres,
                  Random* noise) const;
  // directions: of each joint's last move, pose by pose.
  Station MeasureStation(int number, const PlannedStation& planned, std::span<const std::vector<int>> directions) const;
  // directions: of the two poses, if known.
  CheckLength Check(int number, std::span<const std::vector<int>> directions) const;

  const Scene& scene_;
  std::vector<Model::Sphere> spheres_;  // truth
  Measurements data_;                   // nominal links
  Kinematics truth_;
};

std::vector<Model::Sphere> Simulation::MeasuredSpheres() const {
  Random noise(scene_.noise_seed, kArtifactStream);
  std::vector<Model::Sphere> measured = spheres_;
  for (Model::Sphere& sphere : measured)
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
      joints = {Joints(base_from_scanner, random)};
      for (int t = 0; t < translations && !joints.back().empty(); ++t)
        joints.push_back(
            Joints(Eigen::Translation3d(Translation(scene_.configuration, t)) * base_from_scanner, random));
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

Model::View Simulation::See(const std::vector<double>& joints, const std::vector<double>& terms,
                            const Eigen::Isometry3d& base_from_artifact, const std::vector<Model::Sphere>& spheres,
                            Random* noise) const {
  Model::View view{.name = "", .joints = joints, .terms = terms};
  Eigen::Isometry3d base_from_scanner = BaseFromScanner(data_, truth_, view);
  for (double& x : base_from_scanner.translation()) x += scene_.repeatability * noise->Normal();
  if (scene_.repeatability_rotation > 0) {
    Eigen::Vector3d turn;
    for (double& x : turn) x = scene_.repeatability_rotation * noise->Normal();
    const Eigen::Translation3d flange((base_from_scanner * truth_.flange_from_scanner.inverse()).translation());
    base_from_scanner =
        flange * Eigen::AngleAxisd(turn.norm(), turn.normalized()) * flange.inverse() * base_from_scanner;
  }
  const Eigen::Isometry3d scanner_from_artifact = base_from_scanner.inverse() * base_from_artifact;
  for (size_t b = 0; b < spheres.size(); ++b) {
    Eigen::Vector3d centre = scanner_from_artifact * spheres[b].centre;
    const bool is_seen = centre.norm() <= scene_.field;
    for (double& x : centre) x += scene_.ball_noise * noise->Normal();
    if (is_seen) view.balls.push_back({static_cast<int>(b), centre});
  }
  return view;
}

Station Simulation::MeasureStation(int number, const PlannedStation& planned,
                                   std::span<const std::vector<int>> directions) const {
  Random noise(scene_.noise_seed, static_cast<uint64_t>(number) + 1);
  Station station;
  station.name = std::to_string(number + 1);
  for (size_t v = 0; v < planned.joints.size(); ++v) {
    const std::vector<double>& joints = planned.joints[v];
    station.views.push_back(See(joints,
                                JointTermsAt(data_.links, joints, directions[v], data_.gravity, data_.gear_ratios),
                                planned.base_from_artifact, spheres_, &noise));
    station.views.back().name = station.name + "-" + std::to_string(station.views.size());
  }
  return station;
}

CheckLength Simulation::Check(int number, std::span<const std::vector<int>> directions) const {
  Random random(scene_.seed, kCheckStreams + number), noise(scene_.noise_seed, kCheckStreams + number);
  const PoseSpread spread = SpreadOf(PoseConfiguration::kSpatial);
  CheckLength check;
  check.name = std::to_string(number + 1);
  check.distance = kScaleLength + scene_.u_spheres * Random(scene_.noise_seed, kScaleStream).Normal();
  check.u = scene_.u_spheres;
  while (true) {
    const Eigen::Isometry3d place = DrawPlace(&random);
    std::vector<Model::View> views;
    for (const double half : {-kScaleLength / 2, kScaleLength / 2}) {
      const Model::Sphere ball{"", {half, 0, 0}};
      const Eigen::Isometry3d straight = place * Eigen::Translation3d(ball.centre);
      const std::vector<double> joints = Joints(DrawPose(straight, spread, &random), &random);
      if (joints.empty()) break;
      const std::vector<int> direction =
          directions.empty() ? std::vector<int>(joints.size()) : directions[views.size()];
      views.push_back(See(joints, JointTermsAt(data_.links, joints, direction, data_.gravity, data_.gear_ratios), place,
                          {ball}, &noise));
      views.back().number = 2 * number + (half > 0);
      views.back().name = check.name + (half < 0 ? "-a" : "-b");
    }
    if (views.size() < 2) continue;
    check.first_pose = views[0];
    check.second_pose = views[1];
    return check;
  }
}

Simulated Simulation::Run() const {
  Simulated robot{data_, truth_, {}};
  robot.data.spheres = MeasuredSpheres();
  robot.data.u_spheres = scene_.u_spheres;
  robot.data.ball_diameter = kBallDiameter;
  robot.data.usual_ball_noise = scene_.ball_noise;
  std::vector<PlannedStation> planned;
  for (int k = 0; k < scene_.stations; ++k) planned.push_back(PlanStation(k));
  std::vector<const std::vector<double>*> joints;
  for (const PlannedStation& station : planned)
    for (const std::vector<double>& pose : station.joints) joints.push_back(&pose);
  const std::vector<std::vector<int>> directions = DirectionsOf(joints);
  size_t first = 0;
  int number = 0;
  for (int k = 0; k < scene_.stations; ++k) {
    const PlannedStation& station = planned[static_cast<size_t>(k)];
    robot.data.stations.push_back(
        MeasureStation(k, station, std::span(directions).subspan(first, station.joints.size())));
    first += station.joints.size();
    for (Model::View& view : robot.data.stations.back().views) view.number = number++;
    robot.base_from_artifact.push_back(station.base_from_artifact);
  }
  for (int k = 0; k < scene_.check_positions; ++k) robot.data.check.push_back(Check(k, {}));
  joints.clear();  // which pose comes next is known only now
  for (const CheckLength& check : robot.data.check)
    joints.insert(joints.end(), {&check.first_pose.joints, &check.second_pose.joints});
  const std::vector<std::vector<int>> of_check = DirectionsOf(joints);
  std::vector<CheckLength> moved;
  for (int k = 0; k < scene_.check_positions; ++k)
    moved.push_back(Check(k, std::span(of_check).subspan(2 * static_cast<size_t>(k), 2)));
  robot.data.check = std::move(moved);
  SetTerms(&robot.data);
  return robot;
}

constexpr const char* kScaleBalls[] = {"scale_a", "scale_b"};

Result<void> CheckNumbers(const Scene& scene) {
  if (scene.stations < 1 || scene.poses < 1) return Error{"stations and poses: expected one or more of each"};
  if (scene.translations < 0 || scene.check_positions < 0)
    return Error{"translations and check positions: expected numbers that are not negative"};
  for (const double noise : {scene.repeatability, scene.ball_noise, scene.u_spheres})
    if (!(noise >= 0 && std::isfinite(noise)))
      return Error{"noise of balls, repeatability and u of the artifact: expected numbers that are not negative"};
  return {};
}

std::string Digits(double value, int decimals) {
  std::string digits = fmt::format("{:.{}f}", value, decimals);
  digits.erase(digits.find_last_not_of('0') + 1);
  if (digits.back() == '.') digits.pop_back();
  return digits == "-0" ? "0" : digits;
}

std::string Millimetres(const Eigen::Vector3d& p) {
  constexpr int kDecimals = 6;
  std::string text;
  for (const double x : p) text += "," + Digits(x, kDecimals);
  return text;
}

std::string PoseLine(const std::string& station, const Model::View& view) {
  constexpr int kDecimals = 9;
  std::string line = station + "," + view.name;
  for (const double q : view.joints) line += "," + Digits(q / kDegree, kDecimals);
  return line + "\n";
}

std::string PoseHeader(size_t joints) {
  std::string header = "station,pose";
  for (size_t k = 1; k <= joints; ++k) header += ",q" + std::to_string(k);
  return header + "\n";
}

// poses.csv, balls.csv of stations; `names` of the balls.
struct Tables {
  std::string poses, balls = "pose,ball,x,y,z\n";
  void Add(const std::string& station, const Model::View& view, const std::vector<std::string>& names) {
    poses += PoseLine(station, view);
    for (const Model::SeenBall& ball : view.balls)
      balls += view.name + "," + names[ball.sphere] + Millimetres(ball.centre) + "\n";
  }
};

std::string ArtifactCsv(const Measurements& data) {
  std::string text = data.u_spheres > 0 ? "ball,x,y,z,u\n" : "ball,x,y,z\n";
  for (const Model::Sphere& sphere : data.spheres)
    text +=
        sphere.name + Millimetres(sphere.centre) + (data.u_spheres > 0 ? fmt::format(",{:g}\n", data.u_spheres) : "\n");
  return text;
}

std::string LinksYaml(const std::vector<Link>& links) {
  std::string yaml = "robot:\n  links:\n";
  for (const Link& link : links)
    yaml += fmt::format("    - {{theta: {:g}, d: {:g}, a: {:g}, alpha: {:g}, beta: {:g}}}\n", link.theta / kDegree,
                        link.d, link.a, link.alpha / kDegree, link.beta / kDegree);
  return yaml;
}

std::string Influences(const Scene& scene) {
  std::string list;
  for (const auto& [name, u] : {std::pair{"ball", scene.ball_noise}, {"repeatability", scene.repeatability}})
    if (u > 0) list += fmt::format("{}{}: {:g}", list.empty() ? "" : ", ", name, u);
  return list.empty() ? "" : "influences: {" + list + "}\n";
}

std::string DatasetYaml(const Scene& scene, const Measurements& data, bool declare) {
  std::string yaml = fmt::format(
      "scancal: 1\nmodel: robot-ball\nname: simulated robot, {} stations, seed {}\nunits: {{length: mm, angle: deg}}\n",
      data.stations.size(), scene.seed);
  yaml += LinksYaml(data.links);
  yaml += "poses: poses.csv\nobservations: balls.csv\nartifact: artifact.csv\n";
  yaml += fmt::format("ball_diameter: {:g}\n", data.ball_diameter);
  if (declare) yaml += Influences(scene);
  if (!data.check.empty())
    yaml += "check:\n  poses: check_poses.csv\n  observations: check_balls.csv\n  distances: check_distances.csv\n";
  return yaml;
}

Json Matrix(const Eigen::Isometry3d& pose) {
  Json rows = Json::array();
  for (int i = 0; i < 4; ++i) rows.push_back({pose(i, 0), pose(i, 1), pose(i, 2), pose(i, 3)});
  return rows;
}

Json KinematicsJson(const Kinematics& setup) {
  Json json = {{"hand_eye", Matrix(setup.flange_from_scanner)}, {"link_errors", Json::object()}};
  Quantities names;
  DeclareLinks(setup.link_errors.size(), &names);
  const Eigen::VectorXd numbers = NumbersOf(setup.link_errors);
  for (size_t k = 0; k < names.size(); ++k) json["link_errors"][names[k].name] = numbers[static_cast<Eigen::Index>(k)];
  return json;
}

Json Truth(const Scene& scene, const Simulated& robot) {
  Json truth = {{"units", "mm, rad"}};
  truth.update(KinematicsJson(robot.truth));
  truth["as_default_roles_find_it"] = KinematicsJson(InDefaultGauge(robot.data.links, robot.truth).setup);
  truth["repeatability"] = scene.repeatability;
  truth["ball"] = scene.ball_noise;
  truth["artifact"] = scene.u_spheres;
  truth["seed"] = scene.seed;
  truth["stations"] = Json::array();
  for (size_t k = 0; k < robot.base_from_artifact.size(); ++k)
    truth["stations"].push_back(
        {{"name", robot.data.stations[k].name}, {"base_from_artifact", Matrix(robot.base_from_artifact[k])}});
  return truth;
}

Result<void> WriteCalibrationFiles(const Measurements& data, const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const Model::Sphere& sphere : data.spheres) names.push_back(sphere.name);
  Tables seen{PoseHeader(data.links.size())};
  for (const Station& station : data.stations)
    for (const Model::View& view : station.views) seen.Add(station.name, view, names);
  SCANCAL_RETURN_IF_ERROR(WriteFile(folder / "artifact.csv", ArtifactCsv(data)));
  SCANCAL_RETURN_IF_ERROR(WriteFile(folder / "poses.csv", seen.poses));
  return WriteFile(folder / "balls.csv", seen.balls);
}

Result<void> WriteCheckFiles(const Measurements& data, const std::filesystem::path& folder) {
  if (data.check.empty()) return {};
  Tables seen{PoseHeader(data.links.size())};
  for (const CheckLength& check : data.check) {
    seen.Add(check.name, check.first_pose, {kScaleBalls[0]});
    seen.Add(check.name, check.second_pose, {kScaleBalls[1]});
  }
  const CheckLength& scale = data.check.front();
  std::string distances = scale.u > 0 ? "ball_a,ball_b,distance,u\n" : "ball_a,ball_b,distance\n";
  distances += fmt::format("{},{},{}", kScaleBalls[0], kScaleBalls[1], Digits(scale.distance, 6));
  distances += scale.u > 0 ? fmt::format(",{:g}\n", scale.u) : "\n";
  SCANCAL_RETURN_IF_ERROR(WriteFile(folder / "check_poses.csv", seen.poses));
  SCANCAL_RETURN_IF_ERROR(WriteFile(folder / "check_balls.csv", seen.balls));
  return WriteFile(folder / "check_distances.csv", distances);
}

}  // namespace

std::vector<Model::Sphere> PublishedArtifact() {
  constexpr double kLongest = 1006.863;
  const Eigen::Vector3d first(-503, 18, 6);
  const double along = std::sqrt(kLongest * kLongest - 34 * 34 - 2 * 2);
  const std::vector<Eigen::Vector3d> centres = {
      first,         {-468, -26, 30}, {-436, 22, -4}, {-421, -20, 12},
      {424, 21, 10}, {441, -24, -6},  {471, 25, 28},  first + Eigen::Vector3d(along, -34, -2)};
  std::vector<Model::Sphere> spheres;
  for (const Eigen::Vector3d& centre : centres) spheres.push_back({std::to_string(spheres.size() + 1), centre});
  return spheres;
}

Simulated Simulate(const Scene& scene) { return Simulation(scene).Run(); }

Result<void> WriteSimulated(const Scene& scene, bool declare, const std::filesystem::path& folder) {
  SCANCAL_RETURN_IF_ERROR(CheckNumbers(scene));
  const Simulated robot = Simulate(scene);
  SCANCAL_RETURN_IF_ERROR(WriteCalibrationFiles(robot.data, folder));
  SCANCAL_RETURN_IF_ERROR(WriteCheckFiles(robot.data, folder));
  SCANCAL_RETURN_IF_ERROR(WriteJson(folder / "truth.json", Truth(scene, robot)));
  return WriteFile(folder / "dataset.yaml", DatasetYaml(scene, robot.data, declare));
}

}  // namespace scancal::robot_ball
