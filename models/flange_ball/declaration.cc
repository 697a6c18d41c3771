#include "models/flange_ball/declaration.h"
#include <set>
#include <span>
#include "io/message.h"
#include "models/parts/declared_links.h"
#include "models/parts/declared_parameter.h"
#include "models/parts/joint_columns.h"

namespace scancal {
namespace {

Result<void> CheckSpacing(const Dataset& dataset, const FlangeBall& model) {
  const Quantity& spacing = model.quantities()[FlangeBall::kSpacing];
  if (!(spacing.value > 0))
    return InFile(dataset,
                  "parameters: spacing: expected the distance of the sockets, for example {consider: 50, u: 0.05}: "
                  "it alone tells how long the robot is");
  if (spacing.role == Role::kEstimate && !(spacing.u > 0))
    return InFile(dataset, "parameters: spacing: not determined by these data; give a prior, {estimate: 50, u: 0.05}");
  return {};
}

Result<void> SetInfluence(const InfluenceSetting& setting, const Dataset& dataset, FlangeBall* model) {
  const std::string place = "influences: " + setting.name + ": ";
  const bool seat = setting.name == "seat";
  if (!seat && setting.name != "joints")
    return InFile(dataset, place + "unknown influence" + Suggestion(setting.name, {"joints", "seat"}));
  if (setting.role == "yes" || setting.role == "no" || (setting.role == "estimate" && setting.u > 0))
    return InFile(dataset, place + "expected a standard uncertainty, estimate or hold");
  const double u = setting.u * dataset.units.Of(seat ? Dimension::kLength : Dimension::kAngle);
  if (seat && setting.role != "estimate" && u == 0)
    return InFile(dataset, place + "expected more than 0, or estimate: every pose has noise");
  for (int k = 0; k < std::ssize(model->quantities()); ++k) {
    Quantity& quantity = model->quantity(k);
    if (quantity.source != setting.name) continue;
    quantity.role = setting.role == "estimate" ? Role::kEstimate : u > 0 ? Role::kConsider : Role::kHold;
    quantity.u = u;
  }
  return {};
}

ToolDeclaration ReadDeclaration(YamlMap yaml, const std::filesystem::path& folder, std::set<std::string>* names) {
  ToolDeclaration tool;
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

Result<Table> ReadTable(const std::filesystem::path& file, const FlangeBallDeclaration& declaration, size_t joints) {
  auto table = Table::Read(file, JointColumns(joints), declaration.dataset.units, declaration.columns);
  if (!table.ok()) {
    const bool nameless = declaration.columns.empty() && table.error().kind == ErrorKind::kMissingColumns;
    return Error{table.error().message +
                 (nameless ? "; if the file has no header, declare columns: [q1, q2, ...]" : "")};
  }
  if (table->rows() < 2) return Error{table->name() + ": found 1 pose, expected two or more"};
  SCANCAL_RETURN_IF_ERROR(CheckJoints(*table, joints));
  return table;
}

}  // namespace

std::vector<std::filesystem::path> FlangeBallDeclaration::Files() const {
  std::vector<std::filesystem::path> files = {dataset.file};
  for (const auto* tools : {&targets, &check})
    for (const ToolDeclaration& tool : *tools) files.insert(files.end(), tool.sockets.begin(), tool.sockets.end());
  return files;
}

Result<FlangeBallDeclaration> DeclareFlangeBall(const Dataset& dataset) {
  FlangeBallDeclaration result;
  result.dataset = dataset;
  YamlMap top = dataset.yaml;
  top.Map("robot");  // required
  result.model = FlangeBall(ReadLinks(top, dataset.units));
  FlangeBall& model = result.model;
  if (top.Has("columns")) result.columns = top.Texts("columns");
  std::set<std::string> names;
  const std::filesystem::path folder = dataset.file.parent_path();
  for (const YamlMap& tool : top.Maps("targets")) result.targets.push_back(ReadDeclaration(tool, folder, &names));
  if (result.targets.empty()) top.Fail("targets", "expected at least one location of the tool");
  if (top.Has("check"))
    for (const YamlMap& tool : top.Maps("check")) result.check.push_back(ReadDeclaration(tool, folder, &names));
  const std::span<Quantity> quantities(&model.quantity(0), model.quantities().size());
  SetLinks(ReadLinkSetting(dataset),
           quantities.subspan(FlangeBall::kLinks, model.FirstOfJoints() - FlangeBall::kLinks));
  SCANCAL_RETURN_IF_ERROR(top.Finish());
  for (const ParameterSetting& setting : dataset.parameters)
    if (setting.name != "links")
      SCANCAL_RETURN_IF_ERROR(SetDeclared(setting, dataset, {"links"}, FlangeBall::kSocket, quantities));
  SCANCAL_RETURN_IF_ERROR(CheckSpacing(dataset, model));
  for (const InfluenceSetting& setting : dataset.influences)
    SCANCAL_RETURN_IF_ERROR(SetInfluence(setting, dataset, &model));
  return result;
}

Result<FlangeBall::Target> ReadTool(const ToolDeclaration& tool, const FlangeBallDeclaration& declaration) {
  FlangeBall::Target target;
  target.name = tool.name;
  const size_t joints = declaration.model.links().size();
  for (const int socket : {0, 1}) {
    SCANCAL_ASSIGN_OR_RETURN(const Table table, ReadTable(tool.sockets[socket], declaration, joints));
    for (size_t row = 0; row < table.rows(); ++row) target.views.push_back({JointsOf(table, row, joints), socket});
  }
  return target;
}

}  // namespace scancal
