#include "models/robot_ball/robot_fit.h"
#include <memory>
#include "models/robot_ball/hand_eye.h"

namespace scancal {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

// values: one per quantity of the model.
RobotSetup SetupOf(const std::vector<double>& values, size_t joints) {
  const auto errors =
      Eigen::VectorXd::Map(values.data() + RobotBall::kLinks, kLinkNumbers * static_cast<Eigen::Index>(joints));
  return {PoseOf(Vector6d::Map(&values[RobotBall::kHandEye])), LinksOf(errors)};
}

Error NotDetermined(const Observability& observability) {
  std::string names;
  for (const std::string& name : observability.undetermined) names += (names.empty() ? "" : ", ") + name;
  return Error{names + (observability.undetermined.size() > 1 ? ": are" : ": is") +
               " not determined by these data: hold one of them, give them priors, or add poses that turn about more "
               "directions"};
}

}  // namespace

Result<RobotFit> FitRobot(const RobotData& data, const RobotBall& model, const Eigen::Isometry3d& hand_eye,
                          int max_iterations) {
  std::vector<double> start;
  for (const Quantity& quantity : model.quantities()) start.push_back(quantity.value);
  Vector6d::Map(&start[RobotBall::kHandEye]) = NumbersOf(hand_eye);
  RobotFit fit;
  SCANCAL_ASSIGN_OR_RETURN(fit.stations, StationsAt(data, SetupOf(start, data.links.size())));
  Problem problem = MakeProblem<RobotBall>(std::make_shared<const RobotBall>(model), fit.stations);
  problem.WeighEqually(data.usual_ball_noise > 0 ? data.usual_ball_noise : 1);
  Estimate from = NominalStart(problem);
  SetValues(problem, start, 0, &from);
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
  return SetupOf(Values(solution.problem, solution.fit.estimate, 0), stations.front().views.front().joints.size());
}

Eigen::Isometry3d RobotFit::BaseFromArtifact(size_t station) const {
  const std::vector<double> values = Values(solution.problem, solution.fit.estimate, station);
  const Eigen::Isometry3d turned = PoseOf(Vector6d::Map(&values[RobotBall::kArtifact]));
  const Eigen::Isometry3d& reference = stations[station].base_from_artifact;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = turned.linear() * reference.linear();
  pose.translation() = reference.translation() + turned.translation();
  return pose;
}

}  // namespace scancal
