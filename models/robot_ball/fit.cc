#include "models/robot_ball/fit.h"
#include <glog/logging.h>
#include <memory>
#include "models/robot_ball/start.h"
#include "models/scanner.h"

namespace scancal::robot_ball {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

// values: one per quantity of the model.
Kinematics KinematicsOf(const std::vector<double>& values, size_t joints) {
  const auto errors =
      Eigen::VectorXd::Map(values.data() + Model::kLinks, kLinkNumbers * static_cast<Eigen::Index>(joints));
  return {PoseOf(Vector6d::Map(&values[Model::kHandEye])), LinksOf(errors)};
}

}  // namespace

Result<JointFit> FitJointly(const Measurements& data, const Model& model, const Eigen::Isometry3d& hand_eye,
                            int max_iterations) {
  std::vector<double> start;
  for (const Quantity& quantity : model.quantities()) start.push_back(quantity.value);
  Vector6d::Map(&start[Model::kHandEye]) = NumbersOf(hand_eye);
  JointFit fit;
  SCANCAL_ASSIGN_OR_RETURN(fit.stations, StationsAt(data, KinematicsOf(start, data.links.size())));
  Problem problem = MakeProblem<Model>(std::make_shared<const Model>(model), fit.stations);
  problem.WeighEqually(data.usual_ball_noise > 0 ? data.usual_ball_noise : 1);
  Estimate from = NominalStart(problem);
  SetValues(problem, start, 0, &from);
  fit.solution = Solve(std::move(problem), from, {max_iterations});
  SCANCAL_RETURN_IF_ERROR(CheckDetermined(
      fit.solution.observability,
      {"station", "its balls do not determine where the artifact stands; they need three that are not in a line",
       "these poses, which may turn about too few directions"}));
  fit.solution = SolveWeighted(fit.solution, kLeastSigma_mm, {max_iterations});
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
