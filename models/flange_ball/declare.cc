#include "models/chain/declare.h"
#include <set>
#include <span>
#include "io/message.h"
#include "models/flange_ball/scanner.h"

namespace scancal::flange_ball {
namespace {

Result<void> CheckSpacing(const Dataset& dataset, const Model& model) {
  const Quantity& spacing = model.quantities()[Model::kSpacing];
  if (!(spacing.value > 0))
    return InFile(dataset,
                  "parameters: spacing: expected the distance of the sockets, for example {consider: 50, u: 0.05}: "
                  "it alone tells how long the robot is");
  if (spacing.role == Role::kEstimate && !(spacing.u > 0))
    return InFile(dataset, "parameters: spacing: not determined by these data; give a prior, {estimate: 50, u: 0.05}");
  return {};
}

Result<void> SetInfluence(const InfluenceSetting& setting, const Dataset& dataset, const Arm& arm,
                          size_t first_of_terms, std::span<Quantity> quantities) {
  if (setting.name != "seat" && setting.name != "joints") {
    std::vector<std::string> known = {"joints", "seat"};
    SCANCAL_ASSIGN_OR_RETURN(const bool of_joints,
                             SetJointTerms(setting, dataset, quantities.subspan(first_of_terms), &known));
    if (of_joints) return CheckMotors(setting, arm, dataset);
    return InFile(dataset, "influences: " + setting.name + ": unknown influence" + Suggestion(setting.name, known));
  }
  return SetNoise(setting, dataset, setting.name == "seat" ? "pose" : "", quantities);
}

// Defaults for all locations stand at the top.
ToolDeclaration ReadDeclaration(YamlMap yaml, const Dataset& dataset, size_t joints, std::set<std::string>* names) {
  const std::filesystem::path folder = dataset.file.parent_path();
  ToolDeclaration tool;
  tool.format.units = dataset.units;
  for (const TableColumn& column : JointColumns(joints, ""))
    tool.format.columns.push_back({column.name, column.dimension});
  for (const YamlMap& map : {dataset.yaml, yaml}) {
    ReadColumnNames(map, &tool.format);
    ReadTextFormat(map, &tool.format);
  }
  if (yaml.Has("units")) tool.format.units = ReadUnits(yaml.Map("units"), dataset.units);
  tool.name = yaml.Text("name");
  if (tool.name.empty()) yaml.Fail("name", "expected a name");
  if (!names->insert(tool.name).second) yaml.Fail("name", "expected a name that no other location has");
  const std::vector<std::string> sockets = yaml.Texts("sockets");
  if (sockets.size() != 2 || sockets[0] == sockets[1]) {
    yaml.Fail("sockets", "expected two files of joint angles, [of socket 0, of socket 1]");
  } else {
    tool.sockets = {folder / sockets[0], folder / sockets[1]};
  }
  return tool;
}

Result<Table> ReadTable(const std::filesystem::path& file, ScanFormat format, size_t joints) {
  const char* remedy = format.npy_columns.empty() ? "; if the file has no header, declare columns: [q1, q2, ...]" : "";
  format.path = file;
  SCANCAL_ASSIGN_OR_RETURN(const Table table, Table::Read(std::move(format), JointColumns(joints, remedy)));
  if (table.rows() < 2) return Error{table.name() + ": found 1 pose, expected two or more"};
  SCANCAL_RETURN_IF_ERROR(CheckJoints(table, joints));
  return table;
}

}  // namespace

std::vector<std::filesystem::path> Declaration::Files() const {
  std::vector<std::filesystem::path> files = {dataset.file};
  if (!targets.empty() && !arm.urdf_file.empty()) files.push_back(arm.urdf_file);
  for (const auto* tools : {&targets, &check})
    for (const ToolDeclaration& tool : *tools) files.insert(files.end(), tool.sockets.begin(), tool.sockets.end());
  return files;
}

Result<Declaration> Declare(const Dataset& dataset) {
  Declaration result;
  result.dataset = dataset;
  YamlMap top = dataset.yaml;
  top.Map("robot");  // required
  SCANCAL_ASSIGN_OR_RETURN(result.arm, ReadArm(dataset));
  result.model = Model(result.arm.links);
  Model& model = result.model;
  const size_t joints = model.links().size();
  std::set<std::string> names;
  for (const YamlMap& tool : top.Maps("targets"))
    result.targets.push_back(ReadDeclaration(tool, dataset, joints, &names));
  if (result.targets.empty()) top.Fail("targets", "expected at least one location of the tool");
  if (top.Has("check"))
    for (const YamlMap& tool : top.Maps("check"))
      result.check.push_back(ReadDeclaration(tool, dataset, joints, &names));
  const std::span<Quantity> quantities(&model.quantity(0), model.quantities().size());
  const LinkSetting links = ReadLinkSetting(dataset);
  SCANCAL_RETURN_IF_ERROR(top.Finish());
  SCANCAL_RETURN_IF_ERROR(
      SetParameters(dataset, links, model.links().size(), Model::kLinks, Model::kSocket, quantities));
  SCANCAL_RETURN_IF_ERROR(CheckSpacing(dataset, model));
  for (const InfluenceSetting& setting : dataset.influences)
    SCANCAL_RETURN_IF_ERROR(
        SetInfluence(setting, dataset, result.arm, static_cast<size_t>(model.FirstOfJointTerms()), quantities));
  return result;
}

Result<Model::Target> ReadTool(const ToolDeclaration& tool, const Declaration& declaration) {
  Model::Target target;
  target.name = tool.name;
  const size_t joints = declaration.model.links().size();
  for (const int socket : {0, 1}) {
    SCANCAL_ASSIGN_OR_RETURN(const Table table, ReadTable(tool.sockets[socket], tool.format, joints));
    for (size_t row = 0; row < table.rows(); ++row)
      target.views.push_back({JointsOf(table, row, joints, declaration.arm.couplings), socket});
  }
  SetTerms(declaration.arm, &target);
  return target;
}

}  // namespace scancal::flange_ball
