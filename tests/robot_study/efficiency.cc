#include "tests/robot_study/efficiency.h"
#include <glog/logging.h>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include "models/robot_ball/fit.h"
#include "solver/calibrate.h"
#include "solver/parallel.h"
#include "solver/uncertainty/gum.h"
#include "solver/weigh.h"

namespace scancal::robot_study {
namespace {

using Eigen::VectorXd;

constexpr double kNormal95 = 1.959964;

// The estimated quantities of the system at this setup.
VectorXd Estimated(const Quantities& quantities, const robot_ball::Kinematics& setup) {
  std::vector<double> values(quantities.size());
  VectorXd::Map(&values[robot_ball::Model::kHandEye], 6) = robot_ball::NumbersOf(setup.flange_from_scanner);
  VectorXd::Map(&values[robot_ball::Model::kLinks], kLinkNumbers * std::ssize(setup.link_errors)) =
      NumbersOf(setup.link_errors);
  std::copy(setup.joint_terms.begin(), setup.joint_terms.end(),
            values.begin() + robot_ball::Model::kLinks + kLinkNumbers * std::ssize(setup.link_errors));
  std::vector<double> estimated;
  for (size_t k = 0; k < quantities.size(); ++k)
    if (quantities[k].scope == Scope::kSystem && quantities[k].role == Role::kEstimate) estimated.push_back(values[k]);
  return Eigen::Map<VectorXd>(estimated.data(), std::ssize(estimated));
}

// A turn about the same axis the other way round is the same turn: the rotation vector nearest to that of `to`.
void WrapHandEye(const VectorXd& to, VectorXd* numbers) {
  auto turn = numbers->segment<3>(3);
  const Eigen::Vector3d other = turn * (1 - 2 * std::numbers::pi / turn.norm()), wanted = to.segment<3>(3);
  if ((other - wanted).norm() < (turn - wanted).norm()) turn = other;
}

struct Truth {
  robot_ball::Kinematics setup;
  std::vector<robot_ball::Station> stations;
};

Truth TruthOf(const robot_ball::Simulated& robot) {
  const robot_ball::Gauged gauged = InDefaultGauge(robot.data.links, robot.truth);
  Truth truth{gauged.setup, robot.data.stations};
  for (size_t s = 0; s < truth.stations.size(); ++s)
    truth.stations[s].base_from_artifact = gauged.base_from_true_base * robot.base_from_artifact[s];
  return truth;
}

// Covariance of the estimated quantities of the system.
Eigen::MatrixXd BoundAt(const Truth& truth, const robot_ball::Model& model) {
  Problem problem = MakeProblem<robot_ball::Model>(std::make_shared<const robot_ball::Model>(model), truth.stations);
  Estimate at = NominalStart(problem);
  at.system = Estimated(model.quantities(), truth.setup);
  Weigh(&problem, at);
  return InverseInformation(Linearize(problem, at, Storey::kViews));
}

// Of the mean of n estimated standard deviations, each relative to its true one, from so many runs: those of normal
// numbers with correlation rho have the correlation rho^2.
double ErrorOfMeanRatio(const Eigen::MatrixXd& covariance, double runs) {
  const VectorXd sigma = covariance.diagonal().cwiseSqrt();
  const double squares = covariance.cwiseQuotient(sigma * sigma.transpose()).squaredNorm();
  return std::sqrt(squares / (2 * runs)) / static_cast<double>(sigma.size());
}

struct Try {
  VectorXd error, U;  // empty: failed
};

Try Refined(const robot_ball::Scene& scene, Noise noise, const Truth& truth) {
  const robot_ball::Simulated robot = robot_ball::Simulate(scene);
  const robot_ball::Model model = DeclaredModel(robot.data, scene, noise);
  const Result<robot_ball::JointFit> fit = robot_ball::FitJointly(robot.data, model, robot.truth.flange_from_scanner);
  if (!fit.ok() || !fit->solution.fit.converged) return {};
  const Headline headline = HeadlineOf(fit->solution, ClusteredCovariance(fit->solution.problem, fit->solution.linear));
  VectorXd value = fit->solution.fit.estimate.system;
  const VectorXd wanted = Estimated(model.quantities(), truth.setup);
  WrapHandEye(wanted, &value);
  Try result{value - wanted, headline.covariance.diagonal().cwiseSqrt()};
  for (Eigen::Index k = 0; k < value.size(); ++k) result.U[k] *= CoverageFactor(0.95, headline.dof[k]);
  return result;
}

}  // namespace

Efficiency StudyEfficiency(const robot_ball::Scene& scene, Noise noise, size_t runs, int threads) {
  const robot_ball::Simulated robot = robot_ball::Simulate(scene);
  const Truth truth = TruthOf(robot);
  const robot_ball::Model exactly_known = DeclaredModel(robot.data, scene);
  Efficiency efficiency;
  for (const Quantity& quantity : exactly_known.quantities())
    if (quantity.scope == Scope::kSystem && quantity.role == Role::kEstimate) efficiency.names.push_back(quantity.name);
  const Eigen::MatrixXd bound = BoundAt(truth, exactly_known);
  efficiency.bound = bound.diagonal().cwiseSqrt();
  std::vector<Try> tries(runs);
  InParallel(runs, threads, [&](size_t run) {
    robot_ball::Scene noisy = scene;
    noisy.noise_seed = scene.noise_seed + run;
    tries[run] = Refined(noisy, noise, truth);
  });
  VectorXd squares = VectorXd::Zero(efficiency.bound.size()), held = squares, widths = squares;
  for (const Try& each : tries) {
    if (each.error.size() == 0) {
      ++efficiency.failed;
      continue;
    }
    ++efficiency.runs;
    squares += each.error.cwiseAbs2();
    held += (each.error.cwiseAbs().array() <= each.U.array()).cast<double>().matrix();
    widths += each.U;
  }
  CHECK_GT(efficiency.runs, 0);
  const auto n = static_cast<double>(efficiency.runs);
  efficiency.ratio = (squares / n).cwiseSqrt().cwiseQuotient(efficiency.bound);
  efficiency.u_of_ratio = ErrorOfMeanRatio(bound, n);
  efficiency.coverage = held / n;
  efficiency.width = widths.cwiseQuotient(efficiency.bound) / (n * kNormal95);
  return efficiency;
}

}  // namespace scancal::robot_study
