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

// Three points stand for a 6-DoF target, with the noise of its pose; they agree to rounding, but rows need some of
// their own.
constexpr double kNoiseOfTarget_mm = 1e-3;

struct Files {
  TableDeclaration poses, observations, artifact;  // artifact: none where a tool's points are found from the data
  std::optional<CheckFiles> check;
  int every = 0;  // this pose of the table is held out, and so on; 0: none
};

// What poses and observations are declared to be.
class TableReader {
 public:
  TableReader(const Dataset& dataset, size_t joints, bool measured_in_world)
      : dataset_(dataset), joints_(joints), measured_in_world_(measured_in_world) {}
  TableDeclaration Poses(const YamlMap& map) const {
    return ReadTableDeclaration(map, "poses", dataset_, PoseColumns(joints_, !measured_in_world_), joints_ == 0);
  }
  TableDeclaration Observations(const YamlMap& map) const {
    return ReadTableDeclaration(map, "observations", dataset_,
                                measured_in_world_ ? TrackedColumns() : ObservationColumns(), measured_in_world_);
  }

 private:
  const Dataset& dataset_;
  size_t joints_;
  bool measured_in_world_;
};

Files ReadFiles(const Dataset& dataset, size_t joints, bool measured_in_world) {
  YamlMap top = dataset.yaml;
  const TableReader reader(dataset, joints, measured_in_world);
  Files files{reader.Poses(top), reader.Observations(top), {}, {}};
  const bool is_free = measured_in_world && !top.IsMap("tool") && top.Text("tool", "free") == "free";
  if (!is_free)
    files.artifact = ReadTableDeclaration(top, measured_in_world ? "tool" : "artifact", dataset, ArtifactColumns());
  std::vector<const TableDeclaration*> tables = {&files.poses, &files.observations, &files.artifact};
  if (top.Has("check")) {
    YamlMap check = top.Map("check");
    if (check.Has("every")) {
      const double every = check.Number("every");
      if (every < 2 || every != std::floor(every)) check.Fail("every", "expected a whole number, 2 or more");
      files.every = static_cast<int>(every);
    } else {
      files.check = {reader.Poses(check), reader.Observations(check), {}};
      if (!measured_in_world && check.Has("distances"))
        files.check->distances = ReadTableDeclaration(check, "distances", dataset, DistanceColumns());
      tables.insert(tables.end(), {&files.check->poses, &files.check->observations, &files.check->distances});
    }
  }
  CheckColumnNames(top, tables);
  return files;
}

// One file may hold two tables.
void AddFile(const TableDeclaration& table, std::vector<std::filesystem::path>* files) {
  const std::filesystem::path& path = table.format.path;
  if (!path.empty() && std::find(files->begin(), files->end(), path) == files->end()) files->push_back(path);
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

// Names of all points that were seen, as they first appear.
std::vector<std::string> SeenNames(const Observations& observations) {
  std::vector<std::string> names;
  for (size_t k = 0; k < observations.seen.size(); ++k)
    if (std::find(names.begin(), names.end(), observations.Ball(k)) == names.end())
      names.push_back(observations.Ball(k));
  return names;
}

// What was found of a table's text, and declared of its turns.
void Echo(const Table& table, const TableDeclaration& declared, bool has_turns, std::string* echo) {
  std::string text = table.dialect();
  if (has_turns) text += (text.empty() ? "" : ", ") + ("turns as " + declared.orientation.name());
  if (!text.empty()) *echo += (echo->empty() ? "" : "; ") + declared.format.path.filename().string() + ": " + text;
}

Result<Observations> ReadSeen(const TableDeclaration& declared, const std::filesystem::path& folder,
                              const Declaration& declaration) {
  if (declaration.data.measured_in_world) return ReadTracked(declared);
  return ReadObservations(declared, folder, declaration.data.ball_diameter);
}

std::vector<std::string> BallsOf(const Measurements& data) {
  std::vector<std::string> balls;
  for (const Model::Sphere& sphere : data.spheres) balls.push_back(sphere.name);
  return balls;
}

// Of poses as logged to above the mean of those that the calibration has; without one there is none.
void TakeTemperature(const Poses& poses, const std::optional<double>& mean, std::vector<Station>* stations) {
  for (Station& station : *stations)
    for (Model::View& view : station.views)
      view.warmer = mean && poses.table.Has("temperature") ? view.warmer - *mean : 0;
}

std::optional<double> MeanTemperature(const Poses& poses, const std::vector<Station>& stations) {
  if (!poses.table.Has("temperature")) return std::nullopt;
  double sum = 0, count = 0;
  for (const Station& station : stations)
    for (const Model::View& view : station.views) {
      sum += view.warmer;
      ++count;
    }
  return sum / count;
}

// Every so many poses of the table, by their lines.
void HoldOut(int every, Measurements* data) {
  if (every == 0) return;
  std::vector<Station> kept;
  for (Station& station : data->stations) {
    Station in{station.name, {}}, out{station.name, {}};
    for (Model::View& view : station.views)
      (view.number % every == every - 1 ? out : in).views.push_back(std::move(view));
    if (!in.views.empty()) kept.push_back(std::move(in));
    if (!out.views.empty()) data->held_out.push_back(std::move(out));
  }
  data->stations = std::move(kept);
}

Result<void> TakeStations(const Files& files, const std::filesystem::path& folder, Declaration* result) {
  Measurements& data = result->data;
  const bool has_artifact = !files.artifact.format.path.empty();
  std::string where = files.observations.format.path.string();  // the table of the balls
  if (has_artifact) {
    SCANCAL_ASSIGN_OR_RETURN(const Artifact artifact, ReadArtifact(files.artifact));
    TakeArtifact(artifact, result);
    where = artifact.table.name();
  }
  SCANCAL_ASSIGN_OR_RETURN(Poses poses,
                           ReadPoses(files.poses, data.links, result->arm.couplings, !data.measured_in_world));
  SCANCAL_ASSIGN_OR_RETURN(const Observations observations, ReadSeen(files.observations, folder, *result));
  Echo(poses.table, files.poses, data.links.empty(), &result->echo);
  Echo(observations.table, files.observations, !observations.balls.empty(), &result->echo);
  const std::vector<std::string> balls = has_artifact ? BallsOf(data) : SeenNames(observations);
  const double declared = DeclaredInfluence(result->dataset, "ball");
  SCANCAL_RETURN_IF_ERROR(AttachBalls(observations, balls, where, declared, &poses));
  if (!observations.balls.empty()) {  // of a 6-DoF target: no measured points
    data.spheres = SpheresOfTarget();
    result->u_of_spheres.assign(data.spheres.size(), 0);
  } else if (!has_artifact) {
    SCANCAL_ASSIGN_OR_RETURN(const Shape shape, ShapeOf(poses.stations, balls));
    data.spheres = shape.spheres;
    data.u_spheres = shape.u;
    result->u_of_spheres.assign(data.spheres.size(), shape.u);
  }
  data.usual_ball_noise = observations.balls.empty() ? UsualNoise(observations, declared) : kNoiseOfTarget_mm;
  result->centres_have_u =
      !observations.balls.empty() || (!observations.fitted && observations.table.Has("u") && data.usual_ball_noise > 0);
  data.stations = TakeSeenStations(&poses, &result->warnings);
  data.temperature = MeanTemperature(poses, data.stations);
  TakeTemperature(poses, data.temperature, &data.stations);
  DropCopies(poses.table.name(), &data, &result->warnings);
  HoldOut(files.every, &data);
  SCANCAL_RETURN_IF_ERROR(CheckPoses(data, poses.table.name(), &result->warnings));
  if (!data.measured_in_world) SCANCAL_RETURN_IF_ERROR(CheckBalls(data, observations));
  result->files.insert(result->files.end(), observations.files.begin(), observations.files.end());
  Append(observations.warnings, &result->warnings);
  return {};
}

// Poses and what was seen from them that take no part.
Result<void> TakeHeldOut(const CheckFiles& files, const std::filesystem::path& folder, Declaration* result) {
  Measurements& data = result->data;
  SCANCAL_ASSIGN_OR_RETURN(Poses poses,
                           ReadPoses(files.poses, data.links, result->arm.couplings, !data.measured_in_world));
  SCANCAL_ASSIGN_OR_RETURN(const Observations observations, ReadSeen(files.observations, folder, *result));
  SCANCAL_RETURN_IF_ERROR(
      AttachBalls(observations, BallsOf(data), "the calibration", DeclaredInfluence(result->dataset, "ball"), &poses));
  data.held_out = TakeSeenStations(&poses, &result->warnings);
  TakeTemperature(poses, data.temperature, &data.held_out);
  result->files.insert(result->files.end(), {files.poses.format.path, files.observations.format.path});
  return {};
}

// The hand-eye, where the data set holds all six numbers of it.
std::optional<Eigen::Isometry3d> HeldHandEye(const Dataset& dataset) {
  Eigen::Matrix<double, 6, 1> numbers;
  int held = 0;
  const Model model({}, {});
  for (const ParameterSetting& setting : dataset.parameters) {
    const int k = Find(model.quantities(), setting.name) - Model::kHandEye;
    if (k < 0 || k >= 6 || setting.role != "hold" || !setting.value) continue;
    numbers[k] = *setting.value * UnitFactor(model.quantities()[k].unit, dataset.units);
    ++held;
  }
  if (held < 6) return std::nullopt;
  return PoseOf(numbers);
}

// All that dataset.yaml itself says.
Result<Files> TakeYaml(const Dataset& dataset, Declaration* result) {
  result->dataset = dataset;
  result->data.measured_in_world = dataset.model == kTracker;
  SCANCAL_ASSIGN_OR_RETURN(result->arm, ReadArm(dataset));
  result->data.links = result->arm.links;
  result->data.gravity = result->arm.gravity;
  result->data.gear_ratios = result->arm.gear_ratios;
  const Files files = ReadFiles(dataset, result->data.links.size(), result->data.measured_in_world);
  result->held_out_stand = files.every > 0;
  result->data.hand_eye = HeldHandEye(dataset);
  result->data.ball_diameter = DiameterOf(dataset.yaml, dataset.units);
  result->links = ReadLinkSetting(dataset);
  SCANCAL_RETURN_IF_ERROR(dataset.yaml.Finish());
  return files;
}

const std::vector<std::string> kInfluences = {
    "artifact",       "ball",          "repeatability", "repeatability_rotation",
    "artifact_scale", "scanner_scale", "drift",         "expansion"};

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
    if (model_.quantity(Model::kExpansion).role != Role::kHold && !declaration_.data.temperature)
      return InFile(dataset_,
                    "expansion: nobody logged how warm it was; add a column temperature (degC) to the table of the "
                    "poses, or leave expansion out");
    return {};
  }

 private:
  Result<void> SetInfluence(const InfluenceSetting& setting, std::span<Quantity> quantities) {
    const std::string place = "influences: " + setting.name + ": ";
    const bool has_role = setting.role != "yes" && setting.role != "no";
    if (setting.name == "artifact" && has_role) return SetArtifact(setting, place);
    std::vector<std::string> known = kInfluences;
    SCANCAL_ASSIGN_OR_RETURN(
        const bool of_joints,
        SetJointTerms(setting, dataset_, quantities.subspan(static_cast<size_t>(model_.FirstOfJointTerms())), &known));
    if (of_joints) return CheckMotors(setting, declaration_.arm, dataset_);
    if (std::find(known.begin(), known.end(), setting.name) == known.end())
      return InFile(dataset_, place + "unknown influence" + Suggestion(setting.name, known));
    if (setting.name == "artifact_scale" || setting.name == "scanner_scale" || setting.name == "drift" ||
        setting.name == "expansion")
      return SetSystematic(setting, dataset_, quantities);
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
  SetTerms(&read.data);
  return read;
}

Result<Declaration> Declare(const Dataset& dataset) {
  Declaration result;
  SCANCAL_ASSIGN_OR_RETURN(const Files files, TakeYaml(dataset, &result));
  const std::filesystem::path folder = dataset.file.parent_path();
  Measurements& data = result.data;
  result.files = {dataset.file, files.poses.format.path};
  for (const TableDeclaration* table : {&files.observations, &files.artifact}) AddFile(*table, &result.files);
  if (!result.arm.urdf_file.empty()) result.files.push_back(result.arm.urdf_file);
  SCANCAL_RETURN_IF_ERROR(TakeStations(files, folder, &result));
  if (files.check && files.check->distances.format.path.empty()) {
    SCANCAL_RETURN_IF_ERROR(TakeHeldOut(*files.check, folder, &result));
  } else if (files.check) {
    SCANCAL_ASSIGN_OR_RETURN(CheckLengths check,
                             ReadCheck(*files.check, folder, data.links, result.arm.couplings, data.ball_diameter));
    data.check = std::move(check.lengths);
    for (CheckLength& length : data.check)
      for (Model::View* view : {&length.first_pose, &length.second_pose})
        view->warmer = check.has_temperature && data.temperature ? view->warmer - *data.temperature : 0;
    for (const TableDeclaration* table : {&files.check->poses, &files.check->observations, &files.check->distances})
      AddFile(*table, &result.files);
    result.files.insert(result.files.end(), check.files.begin(), check.files.end());
    Append(check.warnings, &result.warnings);
  }
  SetTerms(&data);
  return result;
}

Result<Model> DeclareModel(const Declaration& declaration) {
  const Measurements& data = declaration.data;
  Model model(data.links, data.spheres, data.measured_in_world);
  SCANCAL_RETURN_IF_ERROR(Setter(declaration, &model).Run());
  return model;
}

}  // namespace scancal::robot_ball
