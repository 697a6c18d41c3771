// A robot that was calibrated before, from the joint angles in its result.
#include "models/flange_ball/flange_ball_scanner.h"

namespace scancal {
namespace {

constexpr char kLayout[] = "targets, check: per location of the tool the joint angles of each pose in rad, by socket";

Json ToolsToJson(const std::vector<FlangeBall::Target>& tools) {
  Json list = Json::array();
  for (const FlangeBall::Target& tool : tools) {
    Json sockets = {Json::array(), Json::array()};
    for (const FlangeBall::View& view : tool.views) sockets[view.socket].push_back(view.joints);
    list.push_back({{"name", tool.name}, {"sockets", sockets}});
  }
  return list;
}

bool IsPose(const Json& pose, size_t joints) {
  return pose.is_array() && pose.size() == joints &&
         std::all_of(pose.begin(), pose.end(), [](const Json& angle) { return angle.is_number(); });
}

bool IsTool(const Json& tool, const std::string& name, size_t joints) {
  if (!tool.is_object() || tool.value("name", Json()) != Json(name) || !tool.contains("sockets")) return false;
  const Json& sockets = tool["sockets"];
  if (!sockets.is_array() || sockets.size() != 2) return false;
  return std::all_of(sockets.begin(), sockets.end(), [&](const Json& poses) {
    return poses.is_array() && poses.size() >= 2 &&
           std::all_of(poses.begin(), poses.end(), [&](const Json& pose) { return IsPose(pose, joints); });
  });
}

Result<std::vector<FlangeBall::Target>> ToolsFromJson(const Json& data, const std::string& key,
                                                      const std::vector<ToolDeclaration>& declared, size_t joints,
                                                      const std::string& file) {
  const Error wrong{file + ": data: " + key +
                    ": expected the joint angles of the locations that data: dataset "
                    "declares, in their order"};
  if (!data.contains(key) || !data[key].is_array() || data[key].size() != declared.size()) return wrong;
  std::vector<FlangeBall::Target> tools;
  for (size_t t = 0; t < declared.size(); ++t) {
    const Json& json = data[key][t];
    if (!IsTool(json, declared[t].name, joints)) return wrong;
    FlangeBall::Target& tool = tools.emplace_back();
    tool.name = declared[t].name;
    for (const int socket : {0, 1})
      for (const Json& pose : json["sockets"][socket]) tool.views.push_back({pose.get<std::vector<double>>(), socket});
  }
  return tools;
}

}  // namespace

Result<Json> FlangeBallScanner::Data() const {
  return Json{{"dataset", declaration_.dataset.text},
              {"layout", kLayout},
              {"targets", ToolsToJson(targets_)},
              {"check", ToolsToJson(check_)}};
}

Result<std::unique_ptr<Scanner>> ReloadFlangeBall(const Dataset& dataset, const Json& data, const std::string& file) {
  SCANCAL_ASSIGN_OR_RETURN(FlangeBallDeclaration declaration, DeclareFlangeBall(dataset));
  const size_t joints = declaration.model.links().size();
  SCANCAL_ASSIGN_OR_RETURN(auto targets, ToolsFromJson(data, "targets", declaration.targets, joints, file));
  SCANCAL_ASSIGN_OR_RETURN(auto check, ToolsFromJson(data, "check", declaration.check, joints, file));
  declaration.targets.clear();  // nothing is left to be read
  declaration.check.clear();
  return std::unique_ptr<Scanner>(
      std::make_unique<FlangeBallScanner>(std::move(declaration), std::move(targets), std::move(check)));
}

}  // namespace scancal
