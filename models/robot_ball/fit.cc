#include "models/robot_ball/fit.h"
#include <glog/logging.h>
#include <memory>
#include <numbers>
#include "models/robot_ball/start.h"
#include "models/scanner.h"

namespace scancal::robot_ball {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

// A turn about the line through two reflectors moves neither: of the rotation vector, what the other numbers leave
// without effect is held at its start. x comes last: the line is the x axis of a tool whose shape was found.
std::vector<std::string> HoldTurnAboutLine(const std::vector<double>& start, Problem* problem, Estimate* at) {
  constexpr double kPart = 1e-7;
  std::vector<int> turns;
  for (int k = Model::kHandEye + 5; k > Model::kHandEye + 2; --k) {
    Quantity& quantity = problem->quantities[k];
    if (quantity.role != Role::kEstimate || quantity.u > 0) continue;
    quantity.value = start[static_cast<size_t>(k)];
    turns.push_back(k);
  }
  if (turns.empty()) return {};
  const std::vector<std::string> held =
      HoldUndetermined(turns, kPart, Linearize(*problem, *at, Storey::kViews), problem);
  *at = NominalStart(*problem);
  SetValues(*problem, start, 0, at);
  return held;
}

}  // namespace

bool IsBeyondHalfATurn(const Solution& solution) {
  const std::vector<double> values = Values(solution.problem, solution.fit.estimate, 0);
  for (int k = Model::kHandEye + 3; k < Model::kHandEye + 6; ++k) {
    const Quantity& quantity = solution.problem.quantities[k];
    if (quantity.role != Role::kEstimate || quantity.u > 0) return false;
  }
  return Eigen::Vector3d::Map(&values[Model::kHandEye + 3]).norm() > std::numbers::pi;
}

Estimate WithinHalfATurn(const Solution& solution) {
  Estimate estimate = solution.fit.estimate;
  for (size_t t = 0; t < estimate.targets.size(); ++t) {
    std::vector<double> values = Values(solution.problem, solution.fit.estimate, t);
    auto turn = Eigen::Vector3d::Map(&values[Model::kHandEye + 3]);
    turn *= 1 - 2 * std::numbers::pi / turn.norm();
    SetValues(solution.problem, values, t, &estimate);
  }
  return estimate;
}

Kinematics KinematicsOf(const std::vector<double>& values, size_t joints) {
  const auto numbers = kLinkNumbers * static_cast<Eigen::Index>(joints);
  const auto terms = values.begin() + Model::kLinks + numbers;
  return {PoseOf(Vector6d::Map(&values[Model::kHandEye])),
          LinksOf(Eigen::VectorXd::Map(values.data() + Model::kLinks, numbers)),
          {terms, terms + CountOfJointTerms(static_cast<int>(joints))},
          values[Model::kExpansion]};
}

Result<JointFit> FitJointly(const Measurements& data, const Model& model, const Eigen::Isometry3d& hand_eye,
                            int max_iterations, bool equal_weights) {
  std::vector<double> start;
  for (const Quantity& quantity : model.quantities()) start.push_back(quantity.value);
  Vector6d::Map(&start[Model::kHandEye]) = NumbersOf(hand_eye);
  JointFit fit;
  SCANCAL_ASSIGN_OR_RETURN(fit.stations, StationsAt(data, KinematicsOf(start, data.links.size())));
  Problem problem = MakeProblem<Model>(std::make_shared<const Model>(model), fit.stations);
  problem.WeighEqually(data.usual_ball_noise > 0 ? data.usual_ball_noise : 1);
  Estimate from = NominalStart(problem);
  SetValues(problem, start, 0, &from);
  if (data.measured_in_world && data.spheres.size() == 2) fit.held_turn = HoldTurnAboutLine(start, &problem, &from);
  fit.held = HoldUndeterminedTerms(model.FirstOfJointTerms(), CountOfJointTerms(static_cast<int>(data.links.size())),
                                   &problem, &from);
  Solution plain = Solve(std::move(problem), from, {max_iterations});
  SCANCAL_RETURN_IF_ERROR(CheckDetermined(
      plain.observability,
      {"station", "its balls do not determine where the artifact stands; they need three that are not in a line",
       "these poses, which may turn about too few directions"}));
  if (IsBeyondHalfATurn(plain)) plain = Solve(plain.problem, WithinHalfATurn(plain), {max_iterations});
  if (equal_weights) {
    fit.solution = std::move(plain);
    return fit;
  }
  fit.solution = SolveWeighted(plain, kLeastSigma_mm, {max_iterations});
  if (IsBeyondHalfATurn(fit.solution)) {  // the weights move it across
    plain = Solve(plain.problem, WithinHalfATurn(fit.solution), {max_iterations});
    fit.solution = SolveWeighted(plain, kLeastSigma_mm, {max_iterations});
  }
  return fit;
}

Kinematics JointFit::Found() const {
  return KinematicsOf(Values(solution.problem, solution.fit.estimate, 0), stations.front().views.front().joints.size());
}

Eigen::Isometry3d JointFit::BaseFromArtifact(size_t station) const {
  const std::vector<double> values = Values(solution.problem, solution.fit.estimate, station);
  const Eigen::Isometry3d turned = PoseOf(Vector6d::Map(&values[Model::kArtifact]));
  const Eigen::Isometry3d& reference = stations[station].base_from_artifact;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = turned.linear() * reference.linear();
  pose.translation() = reference.translation() + turned.translation();
  return pose;
}

Gauged InDefaultGauge(const std::vector<Link>& nominal, const Kinematics& truth) {
  CHECK_EQ(truth.link_errors.size(), nominal.size());
  CHECK(!nominal.empty());
  Gauged gauged{truth, Eigen::Isometry3d::Identity()};
  std::vector<Link>& errors = gauged.setup.link_errors;
  const Link& last = nominal.back();
  // link(q) = Rz(q) link(0)
  gauged.setup.flange_from_scanner = BaseFromFlange({last}, {0}).inverse() *
                                     BaseFromFlange(WithErrors({last}, {errors.back()}), {0}) *
                                     truth.flange_from_scanner;
  errors.back() = {};
  gauged.base_from_true_base = BaseFromFlange({{errors.front().theta, errors.front().d, 0, 0, 0}}, {0}).inverse();
  errors.front().theta = errors.front().d = 0;
  for (size_t k = 0; k + 1 < nominal.size(); ++k) {
    if (!NextAxisIsParallel(nominal[k])) continue;
    errors[k + 1].d += errors[k].d;
    errors[k].d = 0;
  }
  return gauged;
}

}  // namespace scancal::robot_ball
