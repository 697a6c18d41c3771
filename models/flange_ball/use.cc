// What a calibration.json is good for: the same robot again, and where it has its ball.
#include "io/json_file.h"
#include "models/chain/tables.h"
#include "models/flange_ball/scanner.h"

namespace scancal::flange_ball {
namespace {

constexpr char kLayout[] = "targets, check: per location of the tool the joint angles of each pose in rad, by socket";

Json ToolsToJson(const std::vector<Model::Target>& tools) {
  Json list = Json::array();
  for (const Model::Target& tool : tools) {
    Json sockets = {Json::array(), Json::array()};
    for (const Model::View& view : tool.views) sockets[view.socket].push_back(view.joints);
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

Result<std::vector<Model::Target>> ToolsFromJson(const Json& data, const std::string& key,
                                                 const std::vector<ToolDeclaration>& declared, size_t joints,
                                                 const std::string& file) {
  const Error wrong{file + ": data: " + key +
                    ": expected the joint angles of the locations that data: dataset "
                    "declares, in their order"};
  if (!data.contains(key) || !data[key].is_array() || data[key].size() != declared.size()) return wrong;
  std::vector<Model::Target> tools;
  for (size_t t = 0; t < declared.size(); ++t) {
    const Json& json = data[key][t];
    if (!IsTool(json, declared[t].name, joints)) return wrong;
    Model::Target& tool = tools.emplace_back();
    tool.name = declared[t].name;
    for (const int socket : {0, 1})
      for (const Json& pose : json["sockets"][socket]) tool.views.push_back({pose.get<std::vector<double>>(), socket});
  }
  return tools;
}

Result<Robot> CalibratedRobot(const std::vector<Link>& nominal, const Calibration& calibration) {
  SCANCAL_ASSIGN_OR_RETURN(const Eigen::VectorXd ball, ValuesOf(calibration, {"ball_x", "ball_y", "ball_z"}));
  SCANCAL_ASSIGN_OR_RETURN(const std::vector<Link> errors, LinkErrorsOf(calibration, nominal.size()));
  return Robot{WithErrors(nominal, errors), ball, JointTermsOf(calibration, nominal.size())};
}

}  // namespace

Result<Json> Scanner::Data() const {
  Json data = {{"dataset", declaration_.dataset.text},
               {"layout", kLayout},
               {"targets", ToolsToJson(targets_)},
               {"check", ToolsToJson(check_)}};
  KeepUrdf(declaration_.arm, &data);
  return data;
}

Result<std::unique_ptr<scancal::Scanner>> Reload(const Dataset& dataset, const Json& data, const std::string& file) {
  SCANCAL_ASSIGN_OR_RETURN(Declaration declaration, Declare(WithUrdf(dataset, data)));
  const size_t joints = declaration.model.links().size();
  SCANCAL_ASSIGN_OR_RETURN(auto targets, ToolsFromJson(data, "targets", declaration.targets, joints, file));
  SCANCAL_ASSIGN_OR_RETURN(auto check, ToolsFromJson(data, "check", declaration.check, joints, file));
  for (auto* tools : {&targets, &check})
    for (Model::Target& tool : *tools) SetTerms(declaration.arm, &tool);
  declaration.targets.clear();  // nothing is left to be read
  declaration.check.clear();
  return std::unique_ptr<scancal::Scanner>(
      std::make_unique<Scanner>(std::move(declaration), std::move(targets), std::move(check)));
}

Result<int64_t> Transform(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud) {
  SCANCAL_ASSIGN_OR_RETURN(const Declaration declaration, Declare(dataset));
  SCANCAL_ASSIGN_OR_RETURN(const Robot robot, CalibratedRobot(declaration.model.links(), calibration));
  int64_t points = 0;
  int number = 0;
  for (const auto* tools : {&declaration.targets, &declaration.check}) {
    for (const ToolDeclaration& tool : *tools) {
      SCANCAL_ASSIGN_OR_RETURN(const Model::Target target, ReadTool(tool, declaration));
      std::vector<std::array<double, 3>> balls;
      for (const Model::View& view : target.views) {
        const Eigen::Vector3d p = robot.InBase(view);
        balls.push_back({p.x(), p.y(), p.z()});
      }
      SCANCAL_RETURN_IF_ERROR(cloud->Write(balls, number++));
      points += std::ssize(balls);
    }
  }
  return points;
}

}  // namespace scancal::flange_ball
