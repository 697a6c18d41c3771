#include "models/flange_ball/declaration.h"
#include <set>
#include "io/message.h"
#include "models/parts/declared_links.h"

namespace scancal {
namespace {

double InsideUnit(Unit unit, const Units& units) {
  return units.Of(unit == Unit::kMm ? Dimension::kLength : Dimension::kAngle);
}

Error InFile(const Dataset& dataset, const std::string& sentence) { return {dataset.file.string() + ": " + sentence}; }

std::vector<std::string> ParameterNames(const FlangeBall& model) {
  std::vector<std::string> names = {"links"};
  for (const Quantity& quantity : model.quantities())
    if (quantity.scope == Scope::kSystem) names.push_back(quantity.name);
  return names;
}

void SetLinks(const LinkSetting& setting, FlangeBall* model) {
  for (int k = FlangeBall::kLinks; k < model->FirstOfJoints(); ++k) {
    Quantity& quantity = model->quantity(k);
    if (setting.hold) quantity.role = Role::kHold;
    if (quantity.role == Role::kEstimate) quantity.u = quantity.unit == Unit::kMm ? setting.u_length : setting.u_angle;
  }
}

Result<void> SetParameter(const ParameterSetting& setting, const Dataset& dataset, FlangeBall* model) {
  const std::string place = "parameters: " + setting.name + ": ";
  const int index = Find(model->quantities(), setting.name);
  if (index < 0 || model->quantities()[index].scope != Scope::kSystem)
    return InFile(dataset, place + "unknown parameter" + Suggestion(setting.name, ParameterNames(*model)));
  Quantity& quantity = model->quantity(index);
  const double unit = InsideUnit(quantity.unit, dataset.units);
  quantity.role = setting.role == "estimate"   ? Role::kEstimate
                  : setting.role == "consider" ? Role::kConsider
                                               : Role::kHold;
  quantity.value = setting.value.value_or(0) * unit;
  quantity.u = setting.u * unit;
  if (index < FlangeBall::kSocket && quantity.role != Role::kEstimate && !setting.value)
    return InFile(dataset, place + setting.role + ": expected its value, for example {" + setting.role + ": 50}");
  return {};
}

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
  result.model = FlangeBall(ReadLinks(top, dataset.units));
  FlangeBall& model = result.model;
  result.format.units = dataset.units;
  if (top.Has("columns")) result.format.columns = top.Texts("columns");
  std::set<std::string> names;
  const std::filesystem::path folder = dataset.file.parent_path();
  for (const YamlMap& tool : top.Maps("targets")) result.targets.push_back(ReadDeclaration(tool, folder, &names));
  if (result.targets.empty()) top.Fail("targets", "expected at least one location of the tool");
  if (top.Has("check"))
    for (const YamlMap& tool : top.Maps("check")) result.check.push_back(ReadDeclaration(tool, folder, &names));
  SetLinks(ReadLinkSetting(dataset), &model);
  SCANCAL_RETURN_IF_ERROR(top.Finish());
  for (const ParameterSetting& setting : dataset.parameters)
    if (setting.name != "links") SCANCAL_RETURN_IF_ERROR(SetParameter(setting, dataset, &model));
  SCANCAL_RETURN_IF_ERROR(CheckSpacing(dataset, model));
  for (const InfluenceSetting& setting : dataset.influences)
    SCANCAL_RETURN_IF_ERROR(SetInfluence(setting, dataset, &model));
  return result;
}

Result<FlangeBall::Target> ReadTool(const ToolDeclaration& tool, const FlangeBallDeclaration& declaration) {
  FlangeBall::Target target;
  target.name = tool.name;
  for (const int socket : {0, 1}) {
    SCANCAL_ASSIGN_OR_RETURN(std::vector<std::vector<double>> poses,
                             ReadJoints(tool.sockets[socket], declaration.format, declaration.model.links().size()));
    for (std::vector<double>& joints : poses) target.views.push_back({std::move(joints), socket});
  }
  return target;
}

}  // namespace scancal
