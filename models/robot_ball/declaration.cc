#include "models/robot_ball/declaration.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include "models/robot_ball/artifact.h"
#include "models/robot_ball/ball_names.h"
#include "models/robot_ball/check_lengths.h"
#include "models/robot_ball/plausible.h"
#include "models/robot_ball/stations.h"

namespace scancal {
namespace {

struct Files {
  std::filesystem::path poses, observations, artifact;
  std::optional<CheckFiles> check;
};

std::filesystem::path FileAt(YamlMap* yaml, const char* key, const std::filesystem::path& folder) {
  const std::string name = yaml->Text(key);
  if (name.empty()) yaml->Fail(key, "expected the path of a table");
  return folder / name;
}

Files ReadFiles(YamlMap top, const std::filesystem::path& folder) {
  Files files{
      FileAt(&top, "poses", folder), FileAt(&top, "observations", folder), FileAt(&top, "artifact", folder), {}};
  if (top.Has("check")) {
    YamlMap check = top.Map("check");
    files.check = {FileAt(&check, "poses", folder), FileAt(&check, "observations", folder),
                   FileAt(&check, "distances", folder)};
  }
  return files;
}

// Degrees declared as radians, and the other way round: nobody builds an axis at 1.5708 degrees.
void CheckAngle(double angle_rad, const char* key, YamlMap* row) {
  constexpr double kTurn_rad = 2 * std::numbers::pi, kNear = 1e-3;
  const double number = std::abs(angle_rad) * 360 / kTurn_rad;
  if (std::abs(angle_rad) > 2 * kTurn_rad)
    row->Fail(key, fmt::format("expected two turns at most, that is {:.4g} rad; are these degrees? See units: angle",
                               angle_rad));
  if (std::abs(number - kTurn_rad / 4) < kNear || std::abs(number - kTurn_rad / 2) < kNear)
    row->Fail(key, "expected an angle in degrees, that looks like radians; see units: angle");
}

void CheckReach(const std::vector<Link>& links, YamlMap* robot) {
  double reach = 0;
  for (const Link& link : links) reach += std::abs(link.d) + std::abs(link.a);
  if (reach < kLeastReach_mm || reach > kLargestReach_mm)
    robot->Fail("links", fmt::format("the arm is {:.3g} mm long, expected {} mm to {} mm; see units: length", reach,
                                     kLeastReach_mm, kLargestReach_mm));
}

std::vector<Link> ReadLinks(YamlMap top, const Units& units) {
  std::vector<Link> links;
  if (!top.Has("robot")) return links;
  YamlMap robot = top.Map("robot");
  using enum Dimension;
  for (YamlMap row : robot.Maps("links")) {
    const auto length = [&](const char* key) { return row.Number(key) * units.Of(kLength); };
    const auto angle = [&](const char* key, std::optional<double> otherwise = {}) {
      const double value = row.Number(key, otherwise) * units.Of(kAngle);
      CheckAngle(value, key, &row);
      return value;
    };
    links.push_back({angle("theta", 0), length("d"), length("a"), angle("alpha"), angle("beta", 0)});
  }
  CheckReach(links, &robot);
  return links;
}

LinkSetting ReadLinkSetting(const Dataset& dataset) {
  LinkSetting setting;
  YamlMap top = dataset.yaml;
  for (const ParameterSetting& parameter : dataset.parameters) {
    if (parameter.name != "links") continue;
    YamlMap parameters = top.Map("parameters");
    setting.hold = parameter.role == "hold";
    if (parameter.role == "consider" || parameter.value.value_or(0) != 0 || parameter.u > 0)
      parameters.Fail("links", "expected estimate, hold, or {estimate: 0, u_length: ..., u_angle: ...}");
    if (!parameters.IsMap("links") || setting.hold) continue;
    YamlMap links = parameters.Map("links");
    setting.u_length = links.Number("u_length", 0) * dataset.units.length_in_mm;
    setting.u_angle = links.Number("u_angle", 0) * dataset.units.angle_in_rad;
    for (const auto& [key, u] : {std::pair{"u_length", setting.u_length}, {"u_angle", setting.u_angle}})
      if (u < 0) links.Fail(key, "expected a standard uncertainty, not negative");
  }
  return setting;
}

double DiameterOf(YamlMap top, const Units& units) {
  if (!top.Has("ball_diameter")) return 0;
  const double diameter = top.Number("ball_diameter") * units.length_in_mm;
  if (diameter <= 0) top.Fail("ball_diameter", "expected a diameter above 0");
  return diameter;
}

// mm; 0: not declared as a number.
double DeclaredInfluence(const Dataset& dataset, const std::string& name) {
  for (const InfluenceSetting& influence : dataset.influences)
    if (influence.name == name) return influence.u * dataset.units.length_in_mm;
  return 0;
}

void Append(const std::vector<std::string>& more, std::vector<std::string>* all) {
  all->insert(all->end(), more.begin(), more.end());
}

void TakeArtifact(const Artifact& artifact, RobotDeclaration* result) {
  const double declared = DeclaredInfluence(result->dataset, "artifact");
  double squares = 0;
  for (const double u : artifact.u) {
    result->u_of_spheres.push_back(std::isnan(u) ? declared : u);
    squares += std::pow(result->u_of_spheres.back(), 2);
  }
  result->data.spheres = artifact.spheres;
  result->data.u_spheres = std::sqrt(squares / static_cast<double>(artifact.u.size()));
}

Result<void> CheckBalls(const RobotData& data, const Observations& observations) {
  const std::optional<WrongBall> wrong = FindWrongBall(data);
  if (!wrong) return {};
  for (size_t row = 0; row < observations.seen.size(); ++row)
    if (observations.Pose(row) == wrong->pose && observations.Ball(row) == wrong->ball)
      return observations.table.Wrong(row, "ball", "found \"" + wrong->ball + "\", but " + wrong->sentence);
  return Error{observations.table.name() + ": " + wrong->sentence};
}

Result<void> TakeStations(const Files& files, const std::filesystem::path& folder, RobotDeclaration* result) {
  RobotData& data = result->data;
  const Units& units = result->dataset.units;
  SCANCAL_ASSIGN_OR_RETURN(const Artifact artifact, ReadArtifact(files.artifact, units));
  TakeArtifact(artifact, result);
  SCANCAL_ASSIGN_OR_RETURN(PoseTable poses, ReadPoses(files.poses, data.links, units));
  SCANCAL_ASSIGN_OR_RETURN(const Observations observations,
                           ReadObservations(files.observations, folder, units, data.ball_diameter));
  std::vector<std::string> balls;
  for (const RobotBall::Sphere& sphere : data.spheres) balls.push_back(sphere.name);
  const double declared = DeclaredInfluence(result->dataset, "ball");
  SCANCAL_RETURN_IF_ERROR(AttachBalls(observations, balls, artifact.table.name(), declared, &poses));
  data.usual_ball_noise = UsualNoise(observations, declared);
  result->centres_have_u = !observations.fitted && observations.table.Has("u") && data.usual_ball_noise > 0;
  data.stations = TakeSeenStations(&poses, &result->warnings);
  SCANCAL_RETURN_IF_ERROR(CheckPlausible(data, poses.table.name(), &result->warnings));
  SCANCAL_RETURN_IF_ERROR(CheckBalls(data, observations));
  result->files.insert(result->files.end(), observations.files.begin(), observations.files.end());
  Append(observations.warnings, &result->warnings);
  return {};
}

// All that dataset.yaml says itself.
Result<Files> TakeYaml(const Dataset& dataset, RobotDeclaration* result) {
  result->dataset = dataset;
  const Files files = ReadFiles(dataset.yaml, dataset.file.parent_path());
  result->data.links = ReadLinks(dataset.yaml, dataset.units);
  result->data.ball_diameter = DiameterOf(dataset.yaml, dataset.units);
  result->links = ReadLinkSetting(dataset);
  SCANCAL_RETURN_IF_ERROR(dataset.yaml.Finish());
  return files;
}

}  // namespace

Result<RobotDeclaration> RedeclareRobot(const Dataset& dataset, RobotDeclaration read) {
  const size_t joints = read.data.links.size();
  SCANCAL_RETURN_IF_ERROR(TakeYaml(dataset, &read));
  if (read.data.links.size() != joints)
    return Error{dataset.yaml.Where("robot") + ": expected the links that the data were read with"};
  read.files = {dataset.file};
  return read;
}

Result<RobotDeclaration> DeclareRobot(const Dataset& dataset) {
  RobotDeclaration result;
  SCANCAL_ASSIGN_OR_RETURN(const Files files, TakeYaml(dataset, &result));
  const std::filesystem::path folder = dataset.file.parent_path();
  RobotData& data = result.data;
  result.files = {dataset.file, files.poses, files.observations, files.artifact};
  SCANCAL_RETURN_IF_ERROR(TakeStations(files, folder, &result));
  if (files.check) {
    SCANCAL_ASSIGN_OR_RETURN(CheckLengths check,
                             ReadCheck(*files.check, folder, data.links, dataset.units, data.ball_diameter));
    data.check = std::move(check.lengths);
    result.files.insert(result.files.end(), {files.check->poses, files.check->observations, files.check->distances});
    result.files.insert(result.files.end(), check.files.begin(), check.files.end());
    Append(check.warnings, &result.warnings);
  }
  return result;
}

}  // namespace scancal
