// What a calibration.json is good for: the same robot again, and ball centres in its base.
#include <limits>
#include "io/json_file.h"
#include "models/chain/tables.h"
#include "models/robot_ball/scanner.h"
#include "models/robot_ball/start.h"

namespace scancal::robot_ball {
namespace {

constexpr const char* kHandEyeNames[] = {"hand_eye_x",  "hand_eye_y",  "hand_eye_z",
                                         "hand_eye_rx", "hand_eye_ry", "hand_eye_rz"};

template <class Matrix>
Json Numbers(const Matrix& matrix) {  // row by row
  Json json = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) json.push_back(matrix(i, j));
  return json;
}

template <class Matrix>
Matrix MatrixOf(const Json& json) {
  Matrix matrix;
  size_t at = 0;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) matrix(i, j) = json.at(at++).get<double>();
  return matrix;
}

Json PoseJson(const Model::View& pose) {
  Json json = {{"name", pose.name}, {"number", pose.number}, {"joints", pose.joints}, {"balls", Json::array()}};
  if (pose.warmer != 0) json["warmer"] = pose.warmer;
  if (pose.joints.empty()) json["base_from_flange"] = Numbers(pose.base_from_flange.matrix());
  for (const Model::SeenBall& ball : pose.balls) {
    Json seen = {{"sphere", ball.sphere}, {"centre", Numbers(ball.centre)}};
    if (ball.spread != Eigen::Matrix3d::Identity()) seen["spread"] = Numbers(ball.spread);
    json["balls"].push_back(seen);
  }
  return json;
}

// number: of a pose of a result that does not say it.
Model::View PoseOfJson(const Json& json, size_t joints, size_t spheres, int number) {
  Model::View pose;
  pose.name = json.at("name");
  pose.joints = json.at("joints").get<std::vector<double>>();
  if (pose.joints.size() != joints) throw std::out_of_range("joints");
  pose.number = json.value("number", number);
  pose.warmer = json.value("warmer", 0.0);
  if (joints == 0) pose.base_from_flange.matrix() = MatrixOf<Eigen::Matrix4d>(json.at("base_from_flange"));
  for (const Json& each : json.at("balls")) {
    Model::SeenBall& ball = pose.balls.emplace_back();
    ball.sphere = each.at("sphere");
    if (ball.sphere < 0 || static_cast<size_t>(ball.sphere) >= spheres) throw std::out_of_range("sphere");
    ball.centre = MatrixOf<Eigen::Vector3d>(each.at("centre"));
    if (each.contains("spread")) ball.spread = MatrixOf<Eigen::Matrix3d>(each["spread"]);
  }
  return pose;
}

Json StationsJson(const std::vector<Station>& stations) {
  Json json = Json::array();
  for (const Station& station : stations) {
    Json poses = Json::array();
    for (const Model::View& pose : station.views) poses.push_back(PoseJson(pose));
    json.push_back({{"name", station.name}, {"poses", poses}});
  }
  return json;
}

std::vector<Station> StationsOf(const Json& json, size_t joints, size_t spheres) {
  std::vector<Station> stations;
  int number = 0;
  for (const Json& each : json) {
    Station& station = stations.emplace_back();
    station.name = each.at("name");
    for (const Json& pose : each.at("poses")) station.views.push_back(PoseOfJson(pose, joints, spheres, number++));
  }
  return stations;
}

Declaration Parsed(const Json& json) {
  Declaration result;
  Measurements& data = result.data;
  for (const Json& each : json.at("spheres"))
    data.spheres.push_back({each.at("name"), MatrixOf<Eigen::Vector3d>(each.at("centre"))});
  data.links.resize(json.at("joints").get<size_t>());
  data.u_spheres = json.at("u_spheres");
  data.usual_ball_noise = json.at("usual_ball_noise");
  if (json.contains("temperature")) data.temperature = json["temperature"].get<double>();
  result.u_of_spheres = json.at("u_of_spheres").get<std::vector<double>>();
  if (result.u_of_spheres.size() != data.spheres.size()) throw std::out_of_range("u_of_spheres");
  result.centres_have_u = json.at("centres_have_u");
  result.echo = json.value("echo", "");
  for (const Json& each : json.at("warnings")) result.warnings.push_back(SentenceFromJson(each).value());
  data.stations = StationsOf(json.at("stations"), data.links.size(), data.spheres.size());
  data.held_out = StationsOf(json.value("held_out", Json::array()), data.links.size(), data.spheres.size());
  int number = 0;
  constexpr size_t kAny = std::numeric_limits<size_t>::max();  // a length's balls are not of the artifact
  for (const Json& each : json.at("check")) {
    data.check.push_back({each.at("name"), PoseOfJson(each.at("first"), data.links.size(), kAny, number),
                          PoseOfJson(each.at("second"), data.links.size(), kAny, number + 1), each.at("distance"),
                          each.at("u")});
    number += 2;
  }
  for (const CheckLength& length : data.check)
    if (length.first_pose.balls.size() != 1 || length.second_pose.balls.size() != 1) throw std::out_of_range("check");
  return result;
}

Result<Kinematics> KinematicsOf(const Calibration& calibration, size_t links) {
  Kinematics setup;
  SCANCAL_ASSIGN_OR_RETURN(const Eigen::VectorXd hand_eye,
                           ValuesOf(calibration, {std::begin(kHandEyeNames), std::end(kHandEyeNames)}));
  setup.flange_from_scanner = PoseOf(hand_eye);
  SCANCAL_ASSIGN_OR_RETURN(setup.link_errors, LinkErrorsOf(calibration, links));
  setup.joint_terms = JointTermsOf(calibration, links);
  if (const Parameter* expansion = calibration.Find("expansion")) setup.expansion = expansion->value;
  return setup;
}

}  // namespace

Json ToJson(const Declaration& declaration) {
  const Measurements& data = declaration.data;
  Json json = {{"joints", data.links.size()},
               {"u_spheres", data.u_spheres},
               {"usual_ball_noise", data.usual_ball_noise},
               {"u_of_spheres", declaration.u_of_spheres},
               {"centres_have_u", declaration.centres_have_u},
               {"echo", declaration.echo},
               {"warnings", Json::array()},
               {"spheres", Json::array()},
               {"stations", Json::array()},
               {"check", Json::array()},
               {"held_out", StationsJson(data.held_out)}};
  if (data.temperature) json["temperature"] = *data.temperature;
  for (const Sentence& warning : declaration.warnings) json["warnings"].push_back(scancal::ToJson(warning));
  for (const Model::Sphere& sphere : data.spheres)
    json["spheres"].push_back({{"name", sphere.name}, {"centre", Numbers(sphere.centre)}});
  json["stations"] = StationsJson(data.stations);
  for (const CheckLength& length : data.check)
    json["check"].push_back({{"name", length.name},
                             {"first", PoseJson(length.first_pose)},
                             {"second", PoseJson(length.second_pose)},
                             {"distance", length.distance},
                             {"u", length.u}});
  return json;
}

Result<Declaration> FromJson(const Json& data, const std::string& file) {
  try {
    return Parsed(data);
  } catch (const std::exception& error) {  // of the JSON library: a key or a type
    return Error{file + ": data: robot: expected what scancal refine writes; damaged? (" + error.what() + ")"};
  }
}

Result<Json> Scanner::Data() const {
  Json data = {{"dataset", declaration_.dataset.text}, {"robot", ToJson(declaration_)}};
  KeepUrdf(declaration_.arm, &data);
  return data;
}

Result<std::unique_ptr<scancal::Scanner>> Reload(const Dataset& dataset, const Json& data, const std::string& file) {
  SCANCAL_ASSIGN_OR_RETURN(Declaration read, FromJson(data.value("robot", Json()), file));
  SCANCAL_ASSIGN_OR_RETURN(Declaration declaration, Redeclare(WithUrdf(dataset, data), std::move(read)));
  SCANCAL_ASSIGN_OR_RETURN(Model model, DeclareModel(declaration));
  return std::unique_ptr<scancal::Scanner>(std::make_unique<Scanner>(std::move(declaration), std::move(model)));
}

Result<int64_t> Transform(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud) {
  SCANCAL_ASSIGN_OR_RETURN(const Declaration declaration, Declare(dataset));
  const Measurements& data = declaration.data;
  SCANCAL_ASSIGN_OR_RETURN(const Kinematics setup, KinematicsOf(calibration, data.links.size()));
  int64_t points = 0;
  for (size_t t = 0; t < data.stations.size(); ++t) {
    std::vector<std::array<double, 3>> in_base;
    for (const Model::View& pose : data.stations[t].views) {
      const Eigen::Isometry3d base_from_scanner = BaseFromScanner(data, setup, pose);
      for (const Model::SeenBall& ball : pose.balls) {
        const Eigen::Vector3d p = base_from_scanner * data.OnTool(ball);
        in_base.push_back({p.x(), p.y(), p.z()});
      }
    }
    SCANCAL_RETURN_IF_ERROR(cloud->Write(in_base, static_cast<int>(t)));
    points += std::ssize(in_base);
  }
  return points;
}

Result<Propagation> Propagate(const Calibration& calibration, const PointRequest& points, bool distances) {
  const std::vector<Link> nominal = NominalLinksOf(calibration);
  Quantities links, terms;
  DeclareLinks(nominal.size(), &links);
  DeclareJointTerms(nominal.size(), &terms);
  const auto gravity = calibration.frames.find("gravity");
  const Eigen::Vector3d down = gravity == calibration.frames.end() ? Eigen::Vector3d(-Eigen::Vector3d::UnitZ())
                                                                   : Eigen::Vector3d(gravity->second.col(3).head<3>());
  const std::vector<int> unknown(nominal.size());
  for (const Parameter& parameter : calibration.parameters)
    if (parameter.name.starts_with("motor_") && parameter.role != Role::kHold)
      return Error{"propagate: " + parameter.name +
                   ": the calibration does not keep gear ratios, expected one without the motors' turns"};
  return PropagateTool(
      calibration, points, distances,
      [&](const auto& value, const std::vector<double>& joints, const Eigen::Vector3d& at) {
        std::vector<double> errors, of_terms;
        for (const Quantity& quantity : links) errors.push_back(value(quantity.name));
        for (const Quantity& quantity : terms) of_terms.push_back(value(quantity.name));
        Eigen::Matrix<double, 6, 1> hand_eye;
        for (int k = 0; k < 6; ++k) hand_eye[k] = value(kHandEyeNames[k]);
        const Eigen::VectorXd numbers = Eigen::VectorXd::Map(errors.data(), std::ssize(errors));
        const std::vector<double> turned = TurnedJoints(joints, JointTermsAt(nominal, joints, unknown, down), of_terms);
        return Eigen::Vector3d(BaseFromFlange(WithErrors(nominal, LinksOf(numbers)), turned) * (PoseOf(hand_eye) * at));
      });
}

}  // namespace scancal::robot_ball
