#include "models/robot_ball/write_simulated.h"
#include <fmt/format.h>
#include <cmath>
#include "io/json_file.h"
#include "io/output_file.h"
#include "io/units.h"
#include "models/robot_ball/gauge.h"

namespace scancal {
namespace {

constexpr const char* kScaleBalls[] = {"scale_a", "scale_b"};

Result<void> CheckNumbers(const RobotScene& scene) {
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

std::string PoseLine(const std::string& station, const RobotBall::View& view) {
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
struct Seen {
  std::string poses, balls = "pose,ball,x,y,z\n";
  void Add(const std::string& station, const RobotBall::View& view, const std::vector<std::string>& names) {
    poses += PoseLine(station, view);
    for (const RobotBall::SeenBall& ball : view.balls)
      balls += view.name + "," + names[ball.sphere] + Millimetres(ball.centre) + "\n";
  }
};

std::string ArtifactCsv(const RobotData& data) {
  std::string text = data.u_spheres > 0 ? "ball,x,y,z,u\n" : "ball,x,y,z\n";
  for (const RobotBall::Sphere& sphere : data.spheres)
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

std::string Influences(const RobotScene& scene) {
  std::string list;
  for (const auto& [name, u] : {std::pair{"ball", scene.ball_noise}, {"repeatability", scene.repeatability}})
    if (u > 0) list += fmt::format("{}{}: {:g}", list.empty() ? "" : ", ", name, u);
  return list.empty() ? "" : "influences: {" + list + "}\n";
}

std::string DatasetYaml(const RobotScene& scene, const RobotData& data, bool declare) {
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

Json SetupJson(const RobotSetup& setup) {
  Json json = {{"hand_eye", Matrix(setup.flange_from_scanner)}, {"link_errors", Json::object()}};
  Quantities names;
  DeclareLinks(setup.link_errors.size(), &names);
  const Eigen::VectorXd numbers = NumbersOf(setup.link_errors);
  for (size_t k = 0; k < names.size(); ++k) json["link_errors"][names[k].name] = numbers[static_cast<Eigen::Index>(k)];
  return json;
}

Json Truth(const RobotScene& scene, const SimulatedRobot& robot) {
  Json truth = {{"units", "mm, rad"}};
  truth.update(SetupJson(robot.truth));
  truth["as_default_roles_find_it"] = SetupJson(InDefaultGauge(robot.data.links, robot.truth).setup);
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

Result<void> WriteCalibrationFiles(const RobotData& data, const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const RobotBall::Sphere& sphere : data.spheres) names.push_back(sphere.name);
  Seen seen{PoseHeader(data.links.size())};
  for (const Station& station : data.stations)
    for (const RobotBall::View& view : station.views) seen.Add(station.name, view, names);
  SCANCAL_RETURN_IF_ERROR(WriteFile(folder / "artifact.csv", ArtifactCsv(data)));
  SCANCAL_RETURN_IF_ERROR(WriteFile(folder / "poses.csv", seen.poses));
  return WriteFile(folder / "balls.csv", seen.balls);
}

Result<void> WriteCheckFiles(const RobotData& data, const std::filesystem::path& folder) {
  if (data.check.empty()) return {};
  Seen seen{PoseHeader(data.links.size())};
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

Result<void> WriteSimulatedRobot(const RobotScene& scene, bool declare, const std::filesystem::path& folder) {
  SCANCAL_RETURN_IF_ERROR(CheckNumbers(scene));
  const SimulatedRobot robot = SimulateRobot(scene);
  SCANCAL_RETURN_IF_ERROR(WriteCalibrationFiles(robot.data, folder));
  SCANCAL_RETURN_IF_ERROR(WriteCheckFiles(robot.data, folder));
  SCANCAL_RETURN_IF_ERROR(WriteJson(folder / "truth.json", Truth(scene, robot)));
  return WriteFile(folder / "dataset.yaml", DatasetYaml(scene, robot.data, declare));
}

}  // namespace scancal
