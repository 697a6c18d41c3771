#include "models/robot_profiler/scanner.h"
#include <fmt/format.h>
#include <cmath>
#include "io/json_file.h"
#include "io/units.h"
#include "models/chain/tables.h"

namespace scancal::robot_profiler {
namespace {

constexpr Message<std::string_view, std::string_view, double> kEdgeOn{
    "robot_profiler.edge_on",
    "target {}: pose {} sees the plane at {:.0f} degrees from edge-on, where depth tells nothing; leave it out",
    "Prüfkörper {}: Pose {} sieht die Ebene {:.0f} Grad neben streifend, wo die Tiefe nichts sagt; weglassen"};

// The estimated plane of a target.
std::pair<Eigen::Vector3d, double> PlaneOf(const Model::Target& plane, const std::vector<double>& values) {
  const Eigen::Vector3d turn = values[Model::kNormal1] * plane.e1 + values[Model::kNormal2] * plane.e2;
  Eigen::Vector3d normal;
  Rotate(turn.data(), plane.normal, normal.data());
  return {normal, plane.distance + values[Model::kDistance]};
}

// The residual table "poses" (its profile's rms, mm) and the scene in the base: "views", from the profiler's zero to
// the middle of its line.
void AddTables(const Model& model, const std::vector<Model::Target>& planes, const Solution& solution,
               Calibration* result) {
  constexpr double kNearEdge_deg = 10;
  for (size_t t = 0; t < planes.size(); ++t) {
    const std::vector<double> values = Values(solution.problem, solution.fit.estimate, t);
    const std::vector<Eigen::VectorXd> residuals = ResidualsOf(solution, t);
    const auto [normal, distance] = PlaneOf(planes[t], values);
    NumberTable poses = PoseTable(model.links().size(), {{"points", Unit::kOne}, {"rms", Unit::kMm}}),
                views = SightTable();
    for (size_t v = 0; v < planes[t].views.size(); ++v) {
      const Model::View& view = planes[t].views[v];
      const Model::InBase<double> profile = model.At(view, values.data());
      const Eigen::Vector3d origin = Eigen::Vector3d::Map(profile.origin), y = Eigen::Vector3d::Map(profile.along_y),
                            z = Eigen::Vector3d::Map(profile.along_z);
      const Eigen::Vector3d flange = origin - Eigen::Vector3d::Map(profile.arm);
      double depth = 0, along = 0;
      for (const PseudoPoint& p : view.points) {
        depth += p.y / static_cast<double>(view.points.size());
        along += p.z / static_cast<double>(view.points.size());
      }
      poses.names.push_back(view.name);
      AddPose(view.joints, flange, {view.count, residuals[v].norm() / std::sqrt(view.count)}, &poses);
      AddSight(origin, origin + depth * y + along * z, &views);
      const double angle = std::asin(std::min(1.0, std::abs(normal.dot(y.normalized())))) / kDegree;
      if (angle < kNearEdge_deg) result->warnings.push_back(Say(kEdgeOn, planes[t].name, view.name, angle));
    }
    result->targets[t].geometry = {{"normal", {normal[0], normal[1], normal[2]}}, {"distance", {distance}}};
    result->targets[t].residual_tables = {{"poses", poses}};
    result->targets[t].scene = {{"views", views}};
  }
  AddNominal(model.links(), result);
}

Json RowsOf(const Eigen::Matrix4d& matrix) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < 4; ++i)
    for (Eigen::Index j = 0; j < 4; ++j) rows.push_back(matrix(i, j));
  return rows;
}

// What Scanner::Data() keeps; throws what the JSON library does.
void TakeData(const Json& data, Declaration* read) {
  for (const Json& each : data.at("poses")) {
    Model::View& pose = read->poses.emplace_back();
    pose.name = each.at("name");
    pose.joints = each.at("joints").get<std::vector<double>>();
    if (each.contains("base_from_flange"))
      for (size_t k = 0; k < 16; ++k)
        pose.base_from_flange.matrix()(static_cast<Eigen::Index>(k / 4), static_cast<Eigen::Index>(k % 4)) =
            each["base_from_flange"].at(k);
  }
  for (const Json& each : data.at("planes")) {
    Plane& plane = read->planes.emplace_back();
    plane.name = each.at("name");
    plane.set_aside = each.at("set_aside");
    for (const Json& of_pose : each.at("profiles")) {
      Profile& profile = plane.profiles.emplace_back();
      profile.pose = read->poses.size() > of_pose.at("pose").get<size_t>() ? of_pose["pose"].get<size_t>()
                                                                           : throw std::out_of_range("pose");
      profile.count = of_pose.at("count");
      size_t at = 0;
      for (Eigen::Index i = 0; i < 3; ++i)
        for (Eigen::Index j = i; j < 3; ++j) profile.factor(i, j) = of_pose.at("factor").at(at++);
    }
  }
}

}  // namespace

std::string Scanner::Describe() const {
  double points = 0, profiles = 0, off = 0;
  for (const Plane& plane : declaration_.planes) {
    off += plane.set_aside;
    profiles += static_cast<double>(plane.profiles.size());
    for (const Profile& profile : plane.profiles) points += profile.count;
  }
  return Opening(declaration_.dataset, fmt::format("robot-profiler, {} joints", declaration_.arm.links.size())) +
         fmt::format("; {} poses, {} planes, {} profiles, {} points used, {} set aside.", declaration_.poses.size(),
                     declaration_.planes.size(), profiles, points, off) +
         Said(declaration_.arm.couplings);
}

Result<Json> Scanner::Data() const {
  Json data = {{"dataset", declaration_.dataset.text},
               {"layout",
                "poses in the order of their file, rad; planes: profiles with the number of their pose, from "
                "0, and the upper triangle R of their points' rows (1, z, y) = Q R, mm"},
               {"poses", Json::array()},
               {"planes", Json::array()}};
  for (const Model::View& pose : declaration_.poses) {
    Json& json = data["poses"].emplace_back(Json{{"name", pose.name}, {"joints", pose.joints}});
    if (pose.joints.empty()) json["base_from_flange"] = RowsOf(pose.base_from_flange.matrix());
  }
  for (const Plane& plane : declaration_.planes) {
    Json profiles = Json::array();
    for (const Profile& profile : plane.profiles) {
      const ProfileFactor& R = profile.factor;
      profiles.push_back({{"pose", profile.pose},
                          {"count", profile.count},
                          {"factor", {R(0, 0), R(0, 1), R(0, 2), R(1, 1), R(1, 2), R(2, 2)}}});
    }
    data["planes"].push_back({{"name", plane.name}, {"set_aside", plane.set_aside}, {"profiles", profiles}});
  }
  KeepUrdf(declaration_.arm, &data);
  return data;
}

Result<Calibration> Scanner::Calibrate(const RefineChoice& choice) const {
  SCANCAL_RETURN_IF_ERROR(CheckOnlyResidual(choice, "depth"));
  SCANCAL_RETURN_IF_ERROR(CheckMonteCarlo(choice, !choice.equal_weights));
  const Stopwatch watch;
  SCANCAL_ASSIGN_OR_RETURN(const JointFit fit, FitJointly(declaration_.model, TargetsOf(declaration_), choice));
  PureError pure;
  for (const Plane& plane : declaration_.planes)
    for (const Profile& profile : plane.profiles) {
      pure.sum_of_squares += profile.factor(2, 2) * profile.factor(2, 2);
      pure.dof += std::max(0.0, profile.count - 2);
    }
  Calibration result = Conclude(declaration_.dataset,
                                {.solution = fit.solution,
                                 .residual = "depth",
                                 .seconds = watch.Seconds(),
                                 .pure_error = pure,
                                 .warnings = declaration_.warnings},
                                choice.monte_carlo);
  const std::vector<double> values = Values(fit.solution.problem, fit.solution.fit.estimate, 0);
  result.frames["hand_eye"] = robot_ball::PoseOf(Eigen::Matrix<double, 6, 1>::Map(&values[Model::kHandEye])).matrix();
  for (size_t t = 0; t < declaration_.planes.size(); ++t)
    if (declaration_.planes[t].set_aside > 0)
      result.targets[t].set_aside = {{"off the line of their profile", declaration_.planes[t].set_aside}};
  AddTables(declaration_.model, fit.planes, fit.solution, &result);
  return result;
}

Result<std::unique_ptr<scancal::Scanner>> Load(const Dataset& dataset) {
  SCANCAL_ASSIGN_OR_RETURN(Declaration declaration, Declare(dataset));
  return std::unique_ptr<scancal::Scanner>(std::make_unique<Scanner>(std::move(declaration)));
}

Result<std::unique_ptr<scancal::Scanner>> Reload(const Dataset& dataset, const Json& data, const std::string& file) {
  Declaration read;
  try {
    TakeData(data, &read);
  } catch (const std::exception& error) {  // of the JSON library: a key or a type
    return Error{file + ": data: expected what scancal refine writes; damaged? (" + error.what() + ")"};
  }
  SCANCAL_ASSIGN_OR_RETURN(Declaration declaration, Redeclare(WithUrdf(dataset, data), std::move(read)));
  return std::unique_ptr<scancal::Scanner>(std::make_unique<Scanner>(std::move(declaration)));
}

Result<int64_t> Transform(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud) {
  SCANCAL_ASSIGN_OR_RETURN(const Declaration declaration, Declare(dataset));
  std::vector<double> values;
  for (const Quantity& quantity : declaration.model.quantities()) {
    const Parameter* parameter = calibration.Find(quantity.name);
    values.push_back(quantity.scope == Scope::kSystem && parameter ? parameter->value : 0);
  }
  int64_t points = 0;
  for (size_t t = 0; t < declaration.planes.size(); ++t)
    for (const Profile& profile : declaration.planes[t].profiles) {
      const Model::InBase<double> at = declaration.model.At(declaration.poses[profile.pose], values.data());
      std::vector<std::array<double, 3>> in_base(profile.y.size());
      for (size_t i = 0; i < in_base.size(); ++i)
        for (size_t k = 0; k < 3; ++k)
          in_base[i][k] = at.origin[k] + profile.y[i] * at.along_y[k] + profile.z[i] * at.along_z[k];
      SCANCAL_RETURN_IF_ERROR(cloud->Write(in_base, static_cast<int>(t)));
      points += std::ssize(in_base);
    }
  return points;
}

}  // namespace scancal::robot_profiler
