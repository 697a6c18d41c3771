#include "models/robot_ball/declaration.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include "models/robot_ball/artifact.h"
#include "models/robot_ball/check_lengths.h"
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

std::vector<Link> ReadLinks(YamlMap top, const Units& units) {
  std::vector<Link> links;
  if (!top.Has("robot")) return links;
  for (YamlMap row : top.Map("robot").Maps("links")) {
    const auto number = [&](const char* key, Dimension dimension, std::optional<double> otherwise = {}) {
      return row.Number(key, otherwise) * units.Of(dimension);
    };
    using enum Dimension;
    links.push_back({number("theta", kAngle, 0), number("d", kLength), number("a", kLength), number("alpha", kAngle),
                     number("beta", kAngle, 0)});
  }
  if (links.empty()) top.Fail("robot", "expected links: one row a joint, base to flange");
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
  data.stations = SeenStations(poses, &result->warnings);
  result->files.insert(result->files.end(), observations.files.begin(), observations.files.end());
  Append(observations.warnings, &result->warnings);
  return {};
}

}  // namespace

Result<RobotDeclaration> DeclareRobot(const Dataset& dataset) {
  RobotDeclaration result;
  result.dataset = dataset;
  const YamlMap& top = dataset.yaml;
  const std::filesystem::path folder = dataset.file.parent_path();
  const Files files = ReadFiles(top, folder);
  RobotData& data = result.data;
  data.links = ReadLinks(top, dataset.units);
  data.ball_diameter = DiameterOf(top, dataset.units);
  result.links = ReadLinkSetting(dataset);
  SCANCAL_RETURN_IF_ERROR(top.Finish());
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
