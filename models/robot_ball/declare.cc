#include "models/robot_ball/declare.h"
#include <algorithm>
#include <cmath>
#include <span>
#include "io/message.h"
#include "models/robot_ball/judge.h"
#include "models/robot_ball/tables.h"
#include "models/scanner.h"

namespace scancal::robot_ball {
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

void Append(const std::vector<Sentence>& more, std::vector<Sentence>* all) {
  all->insert(all->end(), more.begin(), more.end());
}

void TakeArtifact(const Artifact& artifact, Declaration* result) {
  const double declared = DeclaredInfluence(result->dataset, "artifact");
  double squares = 0;
  for (const double u : artifact.u) {
    result->u_of_spheres.push_back(std::isnan(u) ? declared : u);
    squares += std::pow(result->u_of_spheres.back(), 2);
  }
  result->data.spheres = artifact.spheres;
  result->data.u_spheres = std::sqrt(squares / static_cast<double>(artifact.u.size()));
}

Result<void> CheckBalls(const Measurements& data, const Observations& observations) {
  const std::optional<WrongBall> wrong = FindWrongBall(data);
  if (!wrong) return {};
  for (size_t row = 0; row < observations.seen.size(); ++row)
    if (observations.Pose(row) == wrong->pose && observations.Ball(row) == wrong->ball)
      return observations.table.Wrong(row, "ball", "found \"" + wrong->ball + "\", but " + wrong->sentence);
  return Error{observations.table.name() + ": " + wrong->sentence};
}

Result<void> TakeStations(const Files& files, const std::filesystem::path& folder, Declaration* result) {
  Measurements& data = result->data;
  const Units& units = result->dataset.units;
  SCANCAL_ASSIGN_OR_RETURN(const Artifact artifact, ReadArtifact(files.artifact, units));
  TakeArtifact(artifact, result);
  SCANCAL_ASSIGN_OR_RETURN(Poses poses, ReadPoses(files.poses, data.links, units));
  SCANCAL_ASSIGN_OR_RETURN(const Observations observations,
                           ReadObservations(files.observations, folder, units, data.ball_diameter));
  std::vector<std::string> balls;
  for (const Model::Sphere& sphere : data.spheres) balls.push_back(sphere.name);
  const double declared = DeclaredInfluence(result->dataset, "ball");
  SCANCAL_RETURN_IF_ERROR(AttachBalls(observations, balls, artifact.table.name(), declared, &poses));
  data.usual_ball_noise = UsualNoise(observations, declared);
  result->centres_have_u = !observations.fitted && observations.table.Has("u") && data.usual_ball_noise > 0;
  data.stations = TakeSeenStations(&poses, &result->warnings);
  SCANCAL_RETURN_IF_ERROR(CheckPoses(data, poses.table.name(), &result->warnings));
  SCANCAL_RETURN_IF_ERROR(CheckBalls(data, observations));
  result->files.insert(result->files.end(), observations.files.begin(), observations.files.end());
  Append(observations.warnings, &result->warnings);
  return {};
}

// All that dataset.yaml itself says.
Result<Files> TakeYaml(const Dataset& dataset, Declaration* result) {
  result->dataset = dataset;
  const Files files = ReadFiles(dataset.yaml, dataset.file.parent_path());
  result->data.links = ReadLinks(dataset.yaml, dataset.units);
  result->data.ball_diameter = DiameterOf(dataset.yaml, dataset.units);
  result->links = ReadLinkSetting(dataset);
  SCANCAL_RETURN_IF_ERROR(dataset.yaml.Finish());
  return files;
}

const std::vector<std::string> kInfluences = {"artifact", "ball", "repeatability"};

class Setter {
 public:
  Setter(const Declaration& declaration, Model* model)
      : declaration_(declaration), dataset_(declaration.dataset), model_(*model) {}

  Result<void> Run() {
    const std::span<Quantity> quantities(&model_.quantity(0), model_.FirstOfSpheres());
    SCANCAL_RETURN_IF_ERROR(SetParameters(dataset_, declaration_.links, model_.links().size(), Model::kLinks,
                                          Model::kArtifact, quantities));
    SetDeclaredNoise();
    SetSpheres(Role::kConsider);
    for (const InfluenceSetting& setting : dataset_.influences)
      SCANCAL_RETURN_IF_ERROR(SetInfluence(setting, quantities));
    return {};
  }

 private:
  Result<void> SetInfluence(const InfluenceSetting& setting, std::span<Quantity> quantities) {
    const std::string place = "influences: " + setting.name + ": ";
    const bool has_role = setting.role != "yes" && setting.role != "no";
    if (setting.name == "artifact" && has_role) return SetArtifact(setting, place);
    if (std::find(kInfluences.begin(), kInfluences.end(), setting.name) == kInfluences.end())
      return InFile(dataset_, place + "unknown influence" + Suggestion(setting.name, kInfluences));
    return SetNoise(setting, dataset_, setting.name == "ball" ? "ball" : "", quantities);
  }

  void SetThree(int first, Role role, double u) {
    for (int k = first; k < first + 3; ++k) {
      model_.quantity(k).role = role;
      model_.quantity(k).u = u;
    }
  }

  // Uncertainties in the table of the balls stand for an influence that is not declared.
  void SetDeclaredNoise() {
    if (declaration_.centres_have_u) SetThree(Model::kBall, Role::kConsider, declaration_.data.usual_ball_noise);
  }

  void SetSpheres(Role role) {
    for (size_t k = 0; k < declaration_.u_of_spheres.size(); ++k) {
      const double u = declaration_.u_of_spheres[k];
      SetThree(model_.FirstOfSpheres() + 3 * static_cast<int>(k), u > 0 ? role : Role::kHold, u);
    }
  }

  Result<void> SetArtifact(const InfluenceSetting& setting, const std::string& place) {
    if (setting.role == "estimate" && declaration_.data.u_spheres == 0)
      return InFile(dataset_,
                    place +
                        "expected {estimate: 0, u: ...} or a column u in the table of the artifact: without a prior "
                        "its centres are not determined");
    SetSpheres(setting.role == "estimate"   ? Role::kEstimate
               : setting.role == "consider" ? Role::kConsider
                                            : Role::kHold);
    return {};
  }

  const Declaration& declaration_;
  const Dataset& dataset_;
  Model& model_;
};

}  // namespace

Result<Declaration> Redeclare(const Dataset& dataset, Declaration read) {
  const size_t joints = read.data.links.size();
  SCANCAL_RETURN_IF_ERROR(TakeYaml(dataset, &read));
  if (read.data.links.size() != joints)
    return Error{dataset.yaml.Where("robot") + ": expected the links that the data were read with"};
  read.files = {dataset.file};
  return read;
}

Result<Declaration> Declare(const Dataset& dataset) {
  Declaration result;
  SCANCAL_ASSIGN_OR_RETURN(const Files files, TakeYaml(dataset, &result));
  const std::filesystem::path folder = dataset.file.parent_path();
  Measurements& data = result.data;
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

Result<Model> DeclareModel(const Declaration& declaration) {
  Model model(declaration.data.links, declaration.data.spheres);
  SCANCAL_RETURN_IF_ERROR(Setter(declaration, &model).Run());
  return model;
}

}  // namespace scancal::robot_ball
