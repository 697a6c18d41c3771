#include "tests/robot_study/methods.h"
#include <glog/logging.h>
#include <cmath>
#include "models/robot_ball/fit.h"
#include "models/robot_ball/published.h"
#include "models/robot_ball/start.h"
#include "solver/parallel.h"
#include "tests/robot_study/declared.h"

namespace scancal::robot_study {
namespace {

Result<robot_ball::Kinematics> Nominal(const robot_ball::Measurements& data) {
  return robot_ball::Kinematics{robot_ball::DrawnHandEye(), std::vector<Link>(data.links.size())};
}

// As published: from the poses of one place of the artifact.
Result<robot_ball::Kinematics> FirstHandEye(robot_ball::Measurements data) {
  data.stations.resize(1);
  return VirtualPointHandEye(data);
}

Result<robot_ball::Kinematics> Refinement(const robot_ball::Measurements& data, const robot_ball::Scene& scene) {
  SCANCAL_ASSIGN_OR_RETURN(const robot_ball::Kinematics start, InitialHandEye(data));
  SCANCAL_ASSIGN_OR_RETURN(const robot_ball::JointFit fit,
                           robot_ball::FitJointly(data, DeclaredModel(data, scene), start.flange_from_scanner));
  return fit.Found();
}

}  // namespace

Mean MeanOf(const Eigen::VectorXd& values) {
  const auto n = static_cast<double>(values.size());
  const double mean = values.mean();
  return {mean, std::sqrt((values.array() - mean).square().sum() / (n * (n - 1)))};
}

std::vector<Method> StudyMethods(const robot_ball::Scene& scene, size_t sets, int threads) {
  const std::vector<
      std::pair<std::string, std::function<Result<robot_ball::Kinematics>(const robot_ball::Measurements&)>>>
      methods = {{"nominal", &Nominal},
                 {"Ren 2012", &robot_ball::Ren2012},
                 {"Mu 2017", &robot_ball::Mu2017},
                 {"Zhou 2025", &robot_ball::Zhou2025},
                 {"refinement", [&](const robot_ball::Measurements& data) { return Refinement(data, scene); }},
                 {"first hand-eye only", &FirstHandEye}};
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(sets));
  std::vector<Method> results;
  for (const auto& method : methods) results.push_back({method.first, none, none});
  InParallel(sets, threads, [&](size_t set) {
    robot_ball::Scene own = scene;
    own.seed = scene.seed + set;
    own.noise_seed = scene.noise_seed + set;
    const robot_ball::Simulated robot = robot_ball::Simulate(own);
    for (size_t k = 0; k < methods.size(); ++k) {
      const Result<robot_ball::Kinematics> setup = methods[k].second(robot.data);
      CHECK(setup.ok()) << methods[k].first << ", seed " << own.seed << ": " << setup.error().message;
      const ErrorSize spacing = SizeOfErrors(SpacingErrors(robot.data, *setup));
      results[k].max[static_cast<Eigen::Index>(set)] = spacing.max;
      results[k].mean[static_cast<Eigen::Index>(set)] = spacing.mean;
    }
  });
  return results;
}

}  // namespace scancal::robot_study
