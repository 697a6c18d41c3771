#include "tests/robot_study/methods.h"
#include <glog/logging.h>
#include <cmath>
#include "models/robot_ball/hand_eye.h"
#include "models/robot_ball/mu_2017.h"
#include "models/robot_ball/ren_2012.h"
#include "models/robot_ball/robot_fit.h"
#include "models/robot_ball/spacing.h"
#include "models/robot_ball/virtual_point.h"
#include "models/robot_ball/zhou_2025.h"
#include "tests/in_parallel.h"
#include "tests/robot_study/declared.h"

namespace scancal::robot_study {
namespace {

Result<RobotSetup> Nominal(const RobotData& data) {
  return RobotSetup{DrawnHandEye(), std::vector<Link>(data.links.size())};
}

// As published: from the poses of one place of the artifact.
Result<RobotSetup> FirstHandEye(RobotData data) {
  data.stations.resize(1);
  return VirtualPointHandEye(data);
}

Result<RobotSetup> Refinement(const RobotData& data, const RobotScene& scene) {
  SCANCAL_ASSIGN_OR_RETURN(const RobotSetup start, InitialHandEye(data));
  SCANCAL_ASSIGN_OR_RETURN(const RobotFit fit, FitRobot(data, DeclaredModel(data, scene), start.flange_from_scanner));
  return fit.Setup();
}

}  // namespace

Mean MeanOf(const Eigen::VectorXd& values) {
  const auto n = static_cast<double>(values.size());
  const double mean = values.mean();
  return {mean, std::sqrt((values.array() - mean).square().sum() / (n * (n - 1)))};
}

std::vector<Method> StudyMethods(const RobotScene& scene, size_t sets, int threads) {
  const std::vector<std::pair<std::string, std::function<Result<RobotSetup>(const RobotData&)>>> methods = {
      {"nominal", &Nominal},
      {"Ren 2012", &Ren2012},
      {"Mu 2017", &Mu2017},
      {"Zhou 2025", &Zhou2025},
      {"refinement", [&](const RobotData& data) { return Refinement(data, scene); }},
      {"first hand-eye only", &FirstHandEye}};
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(sets));
  std::vector<Method> results;
  for (const auto& method : methods) results.push_back({method.first, none, none});
  InParallel(sets, threads, [&](size_t set) {
    RobotScene own = scene;
    own.seed = scene.seed + set;
    own.noise_seed = scene.noise_seed + set;
    const SimulatedRobot robot = SimulateRobot(own);
    for (size_t k = 0; k < methods.size(); ++k) {
      const Result<RobotSetup> setup = methods[k].second(robot.data);
      CHECK(setup.ok()) << methods[k].first << ", seed " << own.seed << ": " << setup.error().message;
      const ErrorSize spacing = SizeOfErrors(SpacingErrors(robot.data, *setup));
      results[k].max[static_cast<Eigen::Index>(set)] = spacing.max;
      results[k].mean[static_cast<Eigen::Index>(set)] = spacing.mean;
    }
  });
  return results;
}

}  // namespace scancal::robot_study
