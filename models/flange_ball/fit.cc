#include <algorithm>
#include <memory>
#include "models/flange_ball/scanner.h"
#include "models/scanner.h"
#include "solver/dense.h"

namespace scancal::flange_ball {
namespace {

double CountIn(const Model::Target& tool, int socket) {
  return static_cast<double>(std::count_if(tool.views.begin(), tool.views.end(),
                                           [&](const Model::View& view) { return view.socket == socket; }));
}

// What the flanges of a socket's poses have in common.
Eigen::Matrix<double, 3, 4> MeanFlange(const Robot& robot, const Model::Target& tool, int socket) {
  Eigen::Matrix<double, 3, 4> sum = Eigen::Matrix<double, 3, 4>::Zero();
  for (const Model::View& view : tool.views)
    if (view.socket == socket) sum += robot.FlangeAt(view).affine();
  return sum / CountIn(tool, socket);
}

}  // namespace

Eigen::Vector3d Robot::Socket(const Model::Target& tool, int socket) const {
  return MeanFlange(*this, tool, socket) * ball.homogeneous();
}

// (R - mean R) ball = -(p - mean p) over all poses.
Robot FitBall(const std::vector<Link>& links, const std::vector<Model::Target>& tools) {
  Eigen::Index rows = 0;
  for (const Model::Target& tool : tools) rows += 3 * std::ssize(tool.views);
  Eigen::MatrixXd moved(rows, 4);
  Eigen::Index row = 0;
  for (const Model::Target& tool : tools) {
    const Eigen::Matrix<double, 3, 4> mean[2] = {MeanFlange({links}, tool, 0), MeanFlange({links}, tool, 1)};
    for (const Model::View& view : tool.views) {
      moved.middleRows<3>(row) = BaseFromFlange(links, view.joints).affine() - mean[view.socket];
      row += 3;
    }
  }
  return {links, LeastSquares(moved.leftCols<3>(), -moved.col(3))};
}

Seating SeatingOf(const Robot& robot, const Model::Target& tool) {
  const Eigen::Vector3d sockets[2] = {robot.Socket(tool, 0), robot.Socket(tool, 1)};
  double sum = 0;
  for (const Model::View& view : tool.views) sum += (robot.InBase(view) - sockets[view.socket]).norm();
  return {sum / static_cast<double>(tool.views.size()), (sockets[1] - sockets[0]).norm()};
}

void SetTerms(const Arm& arm, Model::Target* tool) {
  for (const int socket : {0, 1}) {
    std::vector<Model::View*> views;
    for (Model::View& view : tool->views)
      if (view.socket == socket) views.push_back(&view);
    SetTermsInOrder(arm.links, arm.gravity, arm.gear_ratios, views);
  }
}

Result<Solution> FitJointly(const Model& model, std::vector<Model::Target> tools, int max_iterations) {
  const Robot nominal = FitBall(model.links(), tools);
  double spread = kLeastSigma_mm;
  for (Model::Target& tool : tools) {
    Model::SetDirection(nominal.Socket(tool, 1) - nominal.Socket(tool, 0), &tool);
    spread = std::max(spread, SeatingOf(nominal, tool).spread);
  }
  Problem problem = MakeProblem(std::make_shared<const Model>(model), tools);
  problem.WeighEqually(spread);
  Estimate start = NominalStart(problem);
  for (size_t t = 0; t < tools.size(); ++t) {
    std::vector<double> values = Values(problem, start, t);
    Eigen::Vector3d::Map(&values[Model::kSocket]) = nominal.Socket(tools[t], 0);
    if (!(model.quantities()[Model::kBall].u > 0)) Eigen::Vector3d::Map(&values[Model::kBall]) = nominal.ball;
    SetValues(problem, values, t, &start);
  }
  HoldUndeterminedTerms(model.FirstOfJointTerms(), CountOfJointTerms(static_cast<int>(model.links().size())), &problem,
                        &start);
  Solution solution = Solve(std::move(problem), start, {max_iterations});
  SCANCAL_RETURN_IF_ERROR(CheckDetermined(
      solution.observability,
      {"target", "its sockets are not determined; it needs poses in both of them", "these locations of the tool"}));
  return solution;
}

Robot RobotOf(const std::vector<Link>& nominal, const Solution& solution) {
  const std::vector<double> values = Values(solution.problem, solution.fit.estimate, 0);
  const auto errors = Eigen::VectorXd::Map(&values[Model::kLinks], kLinkNumbers * std::ssize(nominal));
  const auto terms = values.end() - CountOfJointTerms(static_cast<int>(nominal.size()));
  return {WithErrors(nominal, LinksOf(errors)), Eigen::Vector3d::Map(&values[Model::kBall]), {terms, values.end()}};
}

}  // namespace scancal::flange_ball
