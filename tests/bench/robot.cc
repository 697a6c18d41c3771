#include <fmt/format.h>
#include <glog/logging.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include "io/units.h"
#include "models/robot_ball/fit.h"
#include "models/robot_ball/simulate.h"
#include "models/robot_ball/start.h"
#include "solver/model.h"
#include "solver/uncertainty/covariance.h"
#include "solver/weigh.h"
#include "tests/bench/comparisons.h"

namespace scancal::bench {
namespace {

using Json = nlohmann::json;

constexpr double kWholeArtifact = 3000;  // mm: every pose sees all balls

robot_ball::Scene Scene(int stations, int poses) {
  robot_ball::Scene scene;
  scene.stations = stations;
  scene.poses = poses;
  scene.translations = scene.check_positions = 0;
  scene.u_spheres = 0;
  return scene;
}

// The noise as simulated.
void DeclareNoise(const robot_ball::Scene& scene, robot_ball::Model* model) {
  for (int k = 0; k < std::ssize(model->quantities()); ++k) {
    Quantity& quantity = model->quantity(k);
    if (quantity.source != "ball" && quantity.source != "repeatability") continue;
    quantity.role = Role::kConsider;
    quantity.u = quantity.source == "ball" ? scene.ball_noise : scene.repeatability;
  }
}

// All 25 link errors with the prior of a data sheet: what the data leave open is held by it.
robot_ball::Model WithPriors(const robot_ball::Measurements& data, const robot_ball::Scene& scene) {
  robot_ball::Model model(data.links, data.spheres);
  DeclareNoise(scene, &model);
  for (size_t link = 0; link < data.links.size(); ++link)
    for (int e = 0; e < kLinkNumbers; ++e) {
      Quantity& quantity = model.quantity(robot_ball::Model::kLinks + kLinkNumbers * static_cast<int>(link) + e);
      const bool beta = e == kLinkNumbers - 1;
      if (beta && !NextAxisIsParallel(data.links[link])) continue;
      if (beta && link + 1 == data.links.size()) continue;
      quantity.role = Role::kEstimate;
      quantity.u = quantity.unit == Unit::kMm ? 0.5 : 0.1 * kDegree;
    }
  return model;
}

struct Joint {  // the fit of both sides
  robot_ball::Measurements data;
  robot_ball::Scene scene;
  std::vector<robot_ball::Station> stations;
  std::shared_ptr<const robot_ball::Model> model;
  Problem problem;
  Estimate from;
};

Joint MakeJoint() {
  Joint joint;
  joint.scene = Scene(8, 8);
  joint.scene.field = kWholeArtifact;
  joint.data = robot_ball::Simulate(joint.scene).data;
  const Result<robot_ball::Kinematics> start = InitialHandEye(joint.data);
  CHECK(start.ok()) << start.error().message;
  Result<std::vector<robot_ball::Station>> stations = StationsAt(joint.data, *start);
  CHECK(stations.ok()) << stations.error().message;
  joint.stations = *std::move(stations);
  joint.model = std::make_shared<const robot_ball::Model>(WithPriors(joint.data, joint.scene));
  joint.problem = MakeProblem<robot_ball::Model>(joint.model, joint.stations);
  joint.from = NominalStart(joint.problem);
  joint.from.system.head<6>() = robot_ball::NumbersOf(start->flange_from_scanner);
  Weigh(&joint.problem, joint.from);
  return joint;
}

Json Rows(const Eigen::MatrixXd& matrix) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) row.push_back(matrix(i, j));
    rows.push_back(row);
  }
  return rows;
}

void WriteForScipy(const Joint& joint, const std::filesystem::path& path) {
  Json start;
  for (const Link& link : joint.data.links)
    start["links"].push_back({link.theta, link.d, link.a, link.alpha, link.beta});
  for (const int k : joint.problem.With({Scope::kSystem}, Role::kEstimate)) {
    start["x"].push_back(0);
    if (k < robot_ball::Model::kLinks) continue;
    start["free"].push_back(k - robot_ball::Model::kLinks);
    start["prior"].push_back(joint.problem.quantities[k].u);
  }
  for (Eigen::Index k = 0; k < joint.from.system.size(); ++k) start["x"][k] = joint.from.system[k];
  for (const robot_ball::Model::Sphere& sphere : joint.data.spheres)
    start["spheres"].push_back({sphere.centre[0], sphere.centre[1], sphere.centre[2]});
  for (size_t s = 0; s < joint.stations.size(); ++s) {
    start["base_from_artifact"].push_back(Rows(joint.stations[s].base_from_artifact.matrix()));
    for (int k = 0; k < 6; ++k) start["x"].push_back(0);
    for (const robot_ball::Model::View& view : joint.stations[s].views) {
      start["station"].push_back(s);
      start["joints"].push_back(view.joints);
      CHECK_EQ(view.balls.size(), joint.data.spheres.size());
      Json balls = Json::array();
      for (const robot_ball::Model::SeenBall& ball : view.balls)
        balls.push_back({ball.centre[0], ball.centre[1], ball.centre[2]});
      start["balls"].push_back(balls);
    }
  }
  start["ball_noise"] = joint.scene.ball_noise;
  start["repeatability"] = joint.scene.repeatability;
  std::ofstream(path) << start;
}

Json RunScipy(const std::filesystem::path& script, const std::filesystem::path& start) {
  const std::filesystem::path answer = start.parent_path() / "scipy_robot.json";
  const std::string command =
      "/usr/bin/python3 '" + script.string() + "' '" + start.string() + "' > '" + answer.string() + "'";
  CHECK_EQ(std::system(command.c_str()), 0) << command;
  return Json::parse(std::ifstream(answer));
}

void CompareWithScipy(const std::filesystem::path& script, const std::filesystem::path& folder, Table* table) {
  Say("robot: 64 poses x 8 balls");
  const Joint joint = MakeJoint();
  Fit fit;
  const double refine_s = MedianSecondsOf([&] { fit = Refine(joint.problem, joint.from); });
  CHECK(fit.converged) << fit.message;
  const auto whole = [&] {
    const Result<robot_ball::Kinematics> start = InitialHandEye(joint.data);
    CHECK(start.ok() && robot_ball::FitJointly(joint.data, *joint.model, start->flange_from_scanner).ok());
  };
  const double whole_s = MedianSecondsOf(whole);
  if (script.empty()) return;
  Say("robot: scipy.optimize.least_squares");
  std::filesystem::create_directories(folder);
  WriteForScipy(joint, folder / "robot.json");
  const Json scipy = RunScipy(script, folder / "robot.json");
  const double seconds = scipy["seconds"], other_cost = scipy["cost"];
  const std::string name =
      fmt::format("robot, 64 poses x 8 balls, {} + {} parameters", joint.from.system.size(), 6 * joint.stations.size());
  table->AddTimes(name + ": solve, against scipy least_squares", refine_s, seconds, 50);
  table->AddTimes("... with the start in closed form, both weightings and what is determined", whole_s, seconds, 0);
  const Eigen::VectorXd u =
      InverseInformation(Linearize(joint.problem, fit.estimate, Storey::kViews)).diagonal().cwiseSqrt();
  double apart = 0;
  for (Eigen::Index k = 0; k < u.size(); ++k)
    apart = std::max(apart, std::abs(fit.estimate.system[k] - scipy["x"][k].get<double>()) / u[k]);
  table->AddAtMost("... same hand-eye and links (in u; as scipy left it)", "", "", fmt::format("{:.1e}", apart), apart,
                   1e-2);
  const double cost = std::abs(fit.cost / other_cost - 1);
  table->AddAtMost("... same sum of squares (relative)", fmt::format("{:.6f}", fit.cost),
                   fmt::format("{:.6f}", other_cost), fmt::format("{:.1e}", cost), cost, 1e-8);
  table->Note(
      fmt::format("Robot: scipy {} ({}), {} calls of the residuals besides those of its Jacobian, which is numerical.",
                  scipy["version"].get<std::string>(), scipy["method"].get<std::string>(), scipy["calls"].get<int>()));
}

// The whole fit; seconds.
double FitSeconds(const robot_ball::Measurements& data, const robot_ball::Scene& scene) {
  robot_ball::Model model(data.links, data.spheres);
  DeclareNoise(scene, &model);
  return SecondsOf([&] {
    const Result<robot_ball::Kinematics> start = InitialHandEye(data);
    CHECK(start.ok()) << start.error().message;
    const Result<robot_ball::JointFit> fit = robot_ball::FitJointly(data, model, start->flange_from_scanner);
    CHECK(fit.ok()) << fit.error().message;
    CHECK(fit->solution.fit.converged) << fit->solution.fit.message;
  });
}

void ComparePoses(const std::string& what, const std::vector<robot_ball::Scene>& scenes, Table* table) {
  std::vector<double> seconds, megabytes;  // per pose
  double first_poses = 0, last_poses = 0;
  for (const robot_ball::Scene& scene : scenes) {
    const int poses = scene.stations * scene.poses;
    Say(fmt::format("robot: {} poses", poses));
    const robot_ball::Measurements data = robot_ball::Simulate(scene).data;
    const ChildRun child = RunInChild([&] { return std::vector{FitSeconds(data, scene)}; });
    seconds.push_back(child.values.at(0) / poses);
    megabytes.push_back(child.peak_mb / poses);
    if (first_poses == 0) first_poses = poses;
    last_poses = poses;
    table->Add({fmt::format("robot, {} stations x {} poses, {}, {:.3g} MB; per pose; other: {:.0f} poses",
                            scene.stations, scene.poses, Seconds(child.values.at(0)), child.peak_mb, first_poses),
                Seconds(seconds.back()), Seconds(seconds.front()), Ratio(seconds.back() / seconds.front()), "", ""});
  }
  constexpr double kMostGrowth = 1.5;
  const double least = *std::min_element(seconds.begin(), seconds.end()), growth = seconds.back() / least;
  table->AddAtMost(fmt::format("... time linear in the {}: each of {:.0f} / cheapest", what, last_poses),
                   Seconds(seconds.back()), Seconds(least), Ratio(growth), growth, kMostGrowth);
  const double before = megabytes[megabytes.size() - 2], memory = megabytes.back() / before;
  table->AddAtMost(fmt::format("... memory: each of {:.0f} / a tenth of them", last_poses),
                   fmt::format("{:.3g} kB", 1e3 * megabytes.back()), fmt::format("{:.3g} kB", 1e3 * before),
                   Ratio(memory), memory, kMostGrowth);
}

}  // namespace

void CompareRobot(const std::filesystem::path& scipy_script, const std::filesystem::path& folder, Table* table) {
  CompareWithScipy(scipy_script, folder, table);
  std::vector<robot_ball::Scene> more_stations, more_poses;
  for (const int count : {125, 1250, 12'500}) more_stations.push_back(Scene(count, 8));
  for (const int count : {125, 1250}) more_poses.push_back(Scene(8, count));
  ComparePoses("stations", more_stations, table);
  ComparePoses("poses of a station", more_poses, table);
  table->Note("Robot, whole fit: start in closed form, equal weights, declared noise per pose, observability.");
}

}  // namespace scancal::bench
