#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <unordered_map>
#include "io/message.h"
#include "models/line/robust_line.h"
#include "models/robot_ball/tables.h"
#include "models/robot_profiler/scanner.h"

namespace scancal::robot_profiler {
namespace {

const std::vector<std::string> kInfluences = {"noise_y", "repeatability", "repeatability_rotation", "scale_y",
                                              "scale_z"};

std::vector<TableColumn> ScanColumns() {
  return {{"pose"},
          {"y", Cells::kNumberOrNothing, Dimension::kLength, true, "; y is the depth, z runs along the line"},
          {"z", Cells::kNumberOrNothing, Dimension::kLength}};
}

Result<void> SetInfluences(const Dataset& dataset, const Arm& arm, Model* model) {
  const std::span<Quantity> quantities(&model->quantity(0), model->quantities().size());
  for (const InfluenceSetting& setting : dataset.influences) {
    std::vector<std::string> known = kInfluences;
    SCANCAL_ASSIGN_OR_RETURN(
        const bool of_joints,
        SetJointTerms(setting, dataset, quantities.subspan(static_cast<size_t>(model->FirstOfJointTerms())), &known));
    if (of_joints) {
      SCANCAL_RETURN_IF_ERROR(CheckMotors(setting, arm, dataset));
      continue;
    }
    if (std::find(known.begin(), known.end(), setting.name) == known.end())
      return InFile(dataset, "influences: " + setting.name + ": unknown influence" + Suggestion(setting.name, known));
    if (setting.name.starts_with("scale_")) {
      SCANCAL_RETURN_IF_ERROR(SetSystematic(setting, dataset, quantities));
    } else {
      SCANCAL_RETURN_IF_ERROR(SetNoise(setting, dataset, setting.name == "noise_y" ? "noise_y" : "", quantities));
    }
  }
  return {};
}

void SetTerms(const Arm& arm, std::vector<Model::View>* poses) {
  std::vector<Model::View*> in_order;
  for (Model::View& pose : *poses) in_order.push_back(&pose);
  SetTermsInOrder(arm.links, arm.gravity, arm.gear_ratios, in_order);
}

// Points off the line of their profile go.
size_t Clean(Profile* profile) {
  constexpr double kOff = 6;  // standard deviations
  constexpr size_t kFewest = 5;
  if (profile->y.size() < kFewest) return 0;
  const RobustLine line = FitRobustLine(profile->y, profile->z);
  const double limit = std::max(kOff * line.scale, 1e-6);
  size_t kept = 0;
  for (size_t i = 0; i < profile->y.size(); ++i) {
    if (std::abs(line.Distance(profile->y[i], profile->z[i])) > limit) continue;
    profile->y[kept] = profile->y[i];
    profile->z[kept++] = profile->z[i];
  }
  const size_t off = profile->y.size() - kept;
  profile->y.resize(kept);
  profile->z.resize(kept);
  return off;
}

// The profiles of a plane: the points of a pose are one.
Result<Plane> ReadPlane(const std::string& name, const TableDeclaration& declared, const robot_ball::Poses& poses) {
  SCANCAL_ASSIGN_OR_RETURN(const Table table, Table::Read(declared.format, ScanColumns()));
  Plane plane{name, {}, 0};
  std::unordered_map<size_t, size_t> places;
  for (size_t row = 0; row < table.rows(); ++row) {
    const auto pose = poses.places.find(table.Text("pose", row));
    if (pose == poses.places.end())
      return table.Wrong(row, "pose",
                         "found \"" + table.Text("pose", row) + "\", which " + poses.table.name() + " does not have");
    const double y = table.Number("y", row), z = table.Number("z", row);
    if (std::isnan(y) || std::isnan(z)) continue;  // no return
    const auto [place, is_new] = places.try_emplace(pose->second.view, plane.profiles.size());
    if (is_new) plane.profiles.push_back({pose->second.view, {}, {}});
    Profile& profile = plane.profiles[place->second];
    profile.y.push_back(y);
    profile.z.push_back(z);
  }
  if (plane.profiles.empty()) return Error{table.name() + ": no points"};
  for (Profile& profile : plane.profiles) {
    plane.set_aside += static_cast<double>(Clean(&profile));
    profile.count = static_cast<double>(profile.y.size());
    profile.factor = Factor(profile.y, profile.z);
  }
  std::sort(plane.profiles.begin(), plane.profiles.end(), [](const auto& a, const auto& b) { return a.pose < b.pose; });
  return plane;
}

struct Tables {
  TableDeclaration poses;
  std::vector<std::pair<std::string, TableDeclaration>> scans;  // of planes, by name
};

// All that dataset.yaml itself says.
Result<Tables> TakeYaml(const Dataset& dataset, Declaration* result) {
  result->dataset = dataset;
  SCANCAL_ASSIGN_OR_RETURN(result->arm, ReadArm(dataset));
  YamlMap top = dataset.yaml;
  Tables tables;
  const size_t joints = result->arm.links.size();
  tables.poses = ReadTableDeclaration(top, "poses", dataset, robot_ball::PoseColumns(joints, false), joints == 0);
  std::set<std::string> names;
  std::vector<const TableDeclaration*> all = {&tables.poses};
  for (YamlMap& target : top.Maps("targets")) {
    const std::string name = target.Text("name");
    if (name.empty() || !names.insert(name).second) target.Fail("name", "expected a name that no other plane has");
    tables.scans.emplace_back(name, ReadTableDeclaration(target, "scan", dataset, ScanColumns()));
  }
  for (const auto& [name, scan] : tables.scans) all.push_back(&scan);
  if (tables.scans.empty()) top.Fail("targets", "expected at least one plane, {name: floor, scan: floor.csv}");
  CheckColumnNames(top, all);
  const LinkSetting links = ReadLinkSetting(dataset);
  SCANCAL_RETURN_IF_ERROR(top.Finish());
  result->model = Model(result->arm.links);
  const std::span<Quantity> quantities(&result->model.quantity(0), result->model.quantities().size());
  SCANCAL_RETURN_IF_ERROR(SetParameters(dataset, links, joints, Model::kLinks, Model::kScaleY, quantities));
  SCANCAL_RETURN_IF_ERROR(SetInfluences(dataset, result->arm, &result->model));
  return tables;
}

}  // namespace

Result<Declaration> Declare(const Dataset& dataset) {
  Declaration result;
  SCANCAL_ASSIGN_OR_RETURN(const Tables tables, TakeYaml(dataset, &result));
  SCANCAL_ASSIGN_OR_RETURN(const robot_ball::Poses poses,
                           robot_ball::ReadPoses(tables.poses, result.arm.links, result.arm.couplings, false));
  for (const robot_ball::Model::View& view : poses.stations.front().views)
    result.poses.push_back({view.name, view.joints, view.base_from_flange});
  SetTerms(result.arm, &result.poses);
  result.files = {dataset.file, tables.poses.format.path};
  if (!result.arm.urdf_file.empty()) result.files.push_back(result.arm.urdf_file);
  for (const auto& [name, scan] : tables.scans) {
    SCANCAL_ASSIGN_OR_RETURN(result.planes.emplace_back(), ReadPlane(name, scan, poses));
    result.files.push_back(scan.format.path);
  }
  return result;
}

Result<Declaration> Redeclare(const Dataset& dataset, Declaration read) {
  SCANCAL_ASSIGN_OR_RETURN(const Tables tables, TakeYaml(dataset, &read));
  bool fits = tables.scans.size() == read.planes.size();
  for (size_t t = 0; t < read.planes.size() && fits; ++t) fits = tables.scans[t].first == read.planes[t].name;
  for (const Model::View& pose : read.poses) fits = fits && pose.joints.size() == read.arm.links.size();
  if (!fits) return Error{dataset.yaml.Where("targets") + ": expected the planes and links that the data are of"};
  SetTerms(read.arm, &read.poses);
  read.files = {dataset.file};
  return read;
}

std::vector<Model::Target> TargetsOf(const Declaration& declaration) {
  std::vector<Model::Target> targets;
  for (const Plane& plane : declaration.planes) {
    Model::Target& target = targets.emplace_back();
    target.name = plane.name;
    for (const Profile& profile : plane.profiles) {
      Model::View& view = target.views.emplace_back(declaration.poses[profile.pose]);
      const std::array<PseudoPoint, 3> points = PseudoPoints(profile.factor);
      view.points.assign(points.begin(), points.end());
      view.count = profile.count;
    }
  }
  return targets;
}

}  // namespace scancal::robot_profiler
