#include "models/robot_ball/fit.h"
#include <limits>
#include <memory>
#include "models/robot_profiler/scanner.h"
#include "solver/dense.h"

namespace scancal::robot_profiler {
namespace {

static_assert(static_cast<int>(Model::kHandEye) == static_cast<int>(robot_ball::Model::kHandEye));
using Vector6d = Eigen::Matrix<double, 6, 1>;

std::vector<double> NominalValues(const Model& model) {
  std::vector<double> values;
  for (const Quantity& quantity : model.quantities()) values.push_back(quantity.value);
  return values;
}

// The 24 turns of a cube onto itself.
std::vector<Eigen::Matrix3d> TurnsOfACube() {
  std::vector<Eigen::Matrix3d> turns;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (const double first : {1.0, -1.0})
        for (const double second : {1.0, -1.0}) {
          if (i == j) continue;
          const Eigen::Vector3d x = first * Eigen::Vector3d::Unit(i), y = second * Eigen::Vector3d::Unit(j);
          turns.push_back((Eigen::Matrix3d() << x, y, x.cross(y)).finished());
        }
  return turns;
}

// Values with the hand-eye from which planes come out flattest, the robot as it is declared: point to plane, and from
// each of the turns.
std::vector<double> FindHandEye(const Model& model, std::vector<Model::Target> planes) {
  constexpr int kIterations = 30;
  Model rigid = model.As(Model::Residuals::kPlane);
  for (Quantity& quantity : std::span(&rigid.quantity(0), rigid.quantities().size())) {
    if (quantity.scope == Scope::kSystem) quantity.role = Role::kHold;
    quantity.u = 0;
  }
  for (int k = Model::kHandEye; k < Model::kHandEye + 6; ++k) rigid.quantity(k).role = Role::kEstimate;
  const auto shared = std::make_shared<const Model>(rigid);
  std::vector<double> best;
  double least = std::numeric_limits<double>::infinity();
  for (const Eigen::Matrix3d& turn : TurnsOfACube()) {
    std::vector<double> values = NominalValues(rigid);
    Eigen::Isometry3d hand_eye = Eigen::Isometry3d::Identity();
    hand_eye.linear() = turn;
    Vector6d::Map(&values[Model::kHandEye]) = robot_ball::NumbersOf(hand_eye);
    PlacePlanes(rigid, values, &planes);
    const Problem problem = MakeProblem(shared, planes);
    Estimate start = NominalStart(problem);
    SetValues(problem, values, 0, &start);
    const Fit fit = Refine(problem, start, {.max_iterations = kIterations});
    if (!(fit.cost < least)) continue;
    least = fit.cost;
    best = Values(problem, fit.estimate, 0);
  }
  auto found = Vector6d::Map(&best[Model::kHandEye]);
  found = robot_ball::NumbersOf(robot_ball::PoseOf(found));  // a turn of at most half a turn
  std::vector<double> values = NominalValues(model);
  Vector6d::Map(&values[Model::kHandEye]) = found;
  return values;
}

bool IsDeclared(const Model& model) {
  for (int k = Model::kHandEye; k < Model::kHandEye + 6; ++k)
    if (model.quantities()[k].role == Role::kEstimate && !(model.quantities()[k].u > 0)) return false;
  return true;
}

}  // namespace

void PlacePlanes(const Model& model, const std::vector<double>& values, std::vector<Model::Target>* planes) {
  for (Model::Target& plane : *planes) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double weights = 0;
    std::vector<std::pair<double, Eigen::Vector3d>> points;
    for (const Model::View& view : plane.views) {
      const Model::InBase<double> profile = model.At(view, values.data());
      for (const PseudoPoint& p : view.points) {
        points.emplace_back(p.weight * p.weight, Eigen::Vector3d::Map(profile.origin) +
                                                     p.y * Eigen::Vector3d::Map(profile.along_y) +
                                                     p.z * Eigen::Vector3d::Map(profile.along_z));
        sum += points.back().first * points.back().second;
        weights += points.back().first;
      }
    }
    const Eigen::Vector3d mean = sum / weights;
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const auto& [weight, p] : points) scatter += weight * (p - mean) * (p - mean).transpose();
    const Eigen::Vector3d normal = EigenOf(scatter).vectors.col(0);
    plane.SetPlane(normal, normal.dot(mean));
  }
}

Result<JointFit> FitJointly(const Model& model, std::vector<Model::Target> planes, const RefineChoice& choice) {
  const std::vector<double> values = IsDeclared(model) ? NominalValues(model) : FindHandEye(model, planes);
  PlacePlanes(model, values, &planes);
  Problem problem = MakeProblem(std::make_shared<const Model>(model), planes);
  Estimate start = NominalStart(problem);
  SetValues(problem, values, 0, &start);
  HoldUndeterminedTerms(model.FirstOfJointTerms(), CountOfJointTerms(static_cast<int>(model.links().size())), &problem,
                        &start);
  Solution plain = Solve(std::move(problem), start, {choice.max_iterations});
  SCANCAL_RETURN_IF_ERROR(CheckDetermined(
      plain.observability,
      {"target", "where its plane lies is not determined; it needs profiles in two directions", "these planes"}));
  if (robot_ball::IsBeyondHalfATurn(plain))
    plain = Solve(plain.problem, robot_ball::WithinHalfATurn(plain), {choice.max_iterations});
  if (!choice.equal_weights) plain = SolveWeighted(plain, kLeastSigma_mm, {choice.max_iterations});
  return JointFit{std::move(planes), std::move(plain)};
}

}  // namespace scancal::robot_profiler
