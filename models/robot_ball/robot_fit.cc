#include "models/robot_ball/robot_fit.h"
#include <memory>
#include "models/robot_ball/hand_eye.h"

namespace scancal {
namespace {

// One value per system quantity.
std::vector<double> SystemValues(const Quantities& quantities, const RobotSetup& setup) {
  std::vector<double> values;
  for (const Quantity& quantity : quantities) values.push_back(quantity.value);
  Eigen::VectorXd::Map(values.data() + RobotBall::kHandEye, 6) = NumbersOf(setup.flange_from_scanner);
  Eigen::VectorXd::Map(values.data() + RobotBall::kLinks, kLinkNumbers * std::ssize(setup.link_errors)) =
      NumbersOf(setup.link_errors);
  return values;
}

Error NotDetermined(const Observability& observability) {
  std::string names;
  for (const std::string& name : observability.undetermined) names += (names.empty() ? "" : ", ") + name;
  return Error{names + (observability.undetermined.size() > 1 ? ": are" : ": is") +
               " not determined by these data: hold one of them, give them priors, or add poses that turn about more "
               "directions"};
}

}  // namespace

Result<RobotFit> FitRobot(const RobotData& data, const RobotBall& model, const RobotSetup& start, int max_iterations) {
  RobotFit fit;
  SCANCAL_ASSIGN_OR_RETURN(fit.stations, StationsAt(data, start));
  Problem problem = MakeProblem<RobotBall>(std::make_shared<const RobotBall>(model), fit.stations);
  problem.WeighEqually(data.usual_ball_noise > 0 ? data.usual_ball_noise : 1);
  Estimate from = NominalStart(problem);
  SetValues(problem, SystemValues(model.quantities(), start), 0, &from);
  fit.solution = Solve(std::move(problem), from, {max_iterations});
  const Observability& observability = fit.solution.observability;
  if (!observability.undetermined_targets.empty())
    return Error{"station " + observability.undetermined_targets.front() +
                 ": its balls do not determine where the artifact stands; they need three that are not in a line"};
  if (!observability.undetermined.empty()) return NotDetermined(observability);
  fit.solution = SolveWeighted(fit.solution, kLeastSigma_mm, {max_iterations});
  return fit;
}

RobotSetup RobotFit::Setup() const {
  const Problem& problem = solution.problem;
  const std::vector<double> values = Values(problem, solution.fit.estimate, 0);
  RobotSetup setup;
  setup.flange_from_scanner = PoseOf(Eigen::Map<const Eigen::Matrix<double, 6, 1>>(&values[RobotBall::kHandEye]));
  for (size_t k = RobotBall::kLinks; problem.quantities[k].name.starts_with("theta_"); k += kLinkNumbers) {
    setup.link_errors.push_back({values[k], values[k + 1], values[k + 2], values[k + 3], values[k + 4]});
    if (k + kLinkNumbers >= values.size()) break;
  }
  return setup;
}

Eigen::Isometry3d RobotFit::BaseFromArtifact(size_t station) const {
  const std::vector<double> values = Values(solution.problem, solution.fit.estimate, station);
  const Eigen::Isometry3d turned = PoseOf(Eigen::Map<const Eigen::Matrix<double, 6, 1>>(&values[RobotBall::kArtifact]));
  const Eigen::Isometry3d& reference = stations[station].base_from_artifact;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = turned.linear() * reference.linear();
  pose.translation() = reference.translation() + turned.translation();
  return pose;
}

}  // namespace scancal
