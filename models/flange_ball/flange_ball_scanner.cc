#include "models/flange_ball/flange_ball_scanner.h"
#include <fmt/format.h>
#include <chrono>
#include <cmath>
#include "io/message.h"
#include "io/progress.h"
#include "models/flange_ball/flange_ball_figures.h"

namespace scancal {
namespace {

double Poses(const std::vector<FlangeBall::Target>& tools) {
  double poses = 0;
  for (const FlangeBall::Target& tool : tools) poses += static_cast<double>(tool.views.size());
  return poses;
}

double MeanSpread(const RobotWithBall& robot, const std::vector<FlangeBall::Target>& tools) {
  double sum = 0;
  for (const FlangeBall::Target& tool : tools) sum += SeatingOf(robot, tool).spread;
  return sum / static_cast<double>(tools.size());
}

// Largest error of the sockets' distance.
double WorstSpacing(const RobotWithBall& robot, const std::vector<FlangeBall::Target>& tools, double spacing) {
  double worst = 0;
  for (const FlangeBall::Target& tool : tools)
    worst = std::max(worst, std::abs(SeatingOf(robot, tool).spacing - spacing));
  return worst;
}

std::map<std::string, std::vector<double>> GeometryOf(const RobotWithBall& robot, const FlangeBall::Target& tool) {
  const Seating seating = SeatingOf(robot, tool);
  const Eigen::Vector3d socket = robot.Socket(tool, 0);
  return {{"spread", {seating.spread}}, {"spacing", {seating.spacing}}, {"socket", {socket[0], socket[1], socket[2]}}};
}

Result<std::vector<FlangeBall::Target>> ReadTools(const std::vector<ToolDeclaration>& tools,
                                                  const FlangeBallDeclaration& declaration) {
  std::vector<FlangeBall::Target> targets;
  for (const ToolDeclaration& tool : tools) {
    SCANCAL_ASSIGN_OR_RETURN(targets.emplace_back(), ReadTool(tool, declaration));
  }
  return targets;
}

}  // namespace

FlangeBallScanner::FlangeBallScanner(FlangeBallDeclaration declaration, std::vector<FlangeBall::Target> targets,
                                     std::vector<FlangeBall::Target> check)
    : declaration_(std::move(declaration)), targets_(std::move(targets)), check_(std::move(check)) {}

std::string FlangeBallScanner::Describe() const {
  const Dataset& dataset = declaration_.dataset;
  return fmt::format(
      "{}: flange-ball, {} joints, lengths in {}, angles in {}; sockets {:g} mm apart; {} locations of the tool with "
      "{} poses, {} more with {} poses held out.",
      dataset.name.empty() ? dataset.file.parent_path().filename().string() : dataset.name,
      declaration_.model.links().size(), dataset.units.length, dataset.units.angle, Spacing(), targets_.size(),
      Poses(targets_), check_.size(), Poses(check_));
}

std::vector<std::filesystem::path> FlangeBallScanner::Files() const { return declaration_.Files(); }

double FlangeBallScanner::Spacing() const { return declaration_.model.quantities()[FlangeBall::kSpacing].value; }

Result<Solution> FlangeBallScanner::Fit(const RefineChoice& choice) const {
  Solution solution = FitFlangeBall(declaration_.model, targets_, choice.max_iterations);
  SCANCAL_RETURN_IF_ERROR(CheckDetermined(solution));
  if (choice.equal_weights) return solution;
  return SolveWeighted(solution, kLeastSigma_mm, {choice.max_iterations});
}

Result<Calibration> FlangeBallScanner::Calibrate(const RefineChoice& choice) const {
  if (!choice.residual.empty() && choice.residual != "depth")
    return Error{"residual: found \"" + choice.residual + "\", but a ball in a socket has no other than its position"};
  if (choice.equal_weights && choice.monte_carlo.trials > 0)
    return Error{"montecarlo: found equal weights, expected estimated ones: only they say how large all noise is"};
  const auto began = std::chrono::steady_clock::now();
  SCANCAL_ASSIGN_OR_RETURN(const Solution solution, Fit(choice));
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;
  Calibration result = Summarize(solution, {});
  Progress progress("Monte Carlo");
  AddResampling(
      solution, choice.monte_carlo, [&](double done) { progress.Show(done); }, &result);
  result.model = kFlangeBall.name;
  result.name = declaration_.dataset.name;
  result.residual = "ball in socket";
  result.seconds = seconds.count();
  const RobotWithBall nominal = FitBall(declaration_.model.links(), targets_),
                      robot = RobotOf(declaration_.model.links(), solution);
  for (size_t t = 0; t < targets_.size(); ++t) result.targets[t].geometry = GeometryOf(robot, targets_[t]);
  for (const FlangeBall::Target& tool : check_) {
    result.check.names.push_back("spacing at " + tool.name);
    result.check.before.push_back(SeatingOf(nominal, tool).spacing - Spacing());
    result.check.after.push_back(SeatingOf(robot, tool).spacing - Spacing());
    result.check.u.push_back(declaration_.model.quantities()[FlangeBall::kSpacing].u);
  }
  AddFlangeBallFigures(declaration_.model.links(), targets_, solution, &result);
  JudgeBall(robot, &result);
  if (!check_.empty()) JudgeHeldOut(MeanSpread(robot, targets_), MeanSpread(robot, check_), &result);
  return result;
}

Result<Comparison> FlangeBallScanner::Compare(const CompareChoice&) const {
  SCANCAL_ASSIGN_OR_RETURN(const Solution solution, Fit({}));
  Comparison comparison;
  comparison.columns = {{"calibrated with/mm"}, {"held out/mm"}, {"worst spacing/mm"}, {"worst, held out/mm"}};
  for (const auto* tools : {&targets_, &check_})
    for (const FlangeBall::Target& tool : *tools) comparison.columns.push_back({tool.name + "/mm"});
  const auto add = [&](const std::string& method, const RobotWithBall& robot, const std::string& note) {
    ComparisonRow& row = comparison.rows.emplace_back();
    row.method = method;
    row.note = note;
    row.cells = {{MeanSpread(robot, targets_)}, {}, {WorstSpacing(robot, targets_, Spacing())}, {}};
    if (!check_.empty()) {
      row.cells[1].value = MeanSpread(robot, check_);
      row.cells[3].value = WorstSpacing(robot, check_, Spacing());
    }
    for (const auto* tools : {&targets_, &check_})
      for (const FlangeBall::Target& tool : *tools) row.cells.push_back({SeatingOf(robot, tool).spread});
  };
  add("nominal, ball fitted", FitBall(declaration_.model.links(), targets_), "");
  add("refined", RobotOf(declaration_.model.links(), solution), solution.fit.message);
  return comparison;
}

Result<void> FlangeBallScanner::WriteSurface(const std::filesystem::path&) const {
  return Error{"the model flange-ball has no search over a box"};
}

Result<void> CheckDetermined(const Solution& solution) {
  const Observability& seen = solution.observability;
  if (!seen.undetermined_targets.empty())
    return Error{"target " + Listed(seen.undetermined_targets) +
                 ": its sockets are not determined; it needs poses in both of them"};
  if (!seen.undetermined.empty())
    return Error{Listed(seen.undetermined) + ": not determined by these locations of the tool; hold " +
                 (seen.undetermined.size() == 1 ? "it" : "one of them") + " or give a prior, {estimate: 0, u: ...}"};
  return {};
}

// On the axis the last joint has no say, and the link before must place a mere point: three of its four numbers and
// the ball's height do that together.
void JudgeBall(const RobotWithBall& robot, Calibration* calibration) {
  constexpr double kNearAxis_mm = 5;
  const std::string before = std::to_string(robot.links.size() - 1);
  const double from_axis = robot.ball.head<2>().norm();
  if (from_axis > kNearAxis_mm || robot.links.size() < 2) return;
  std::string free;
  for (const char* name : {"theta_", "d_", "a_", "alpha_"}) {
    const Parameter* parameter = calibration->Find(name + before);
    if (!parameter || parameter->role != Role::kEstimate) return;
    free += (free.empty() ? "" : ", ") + parameter->name;
  }
  calibration->warnings.push_back(fmt::format(
      "the ball lies {:.2g} mm from the axis of the last joint: {} and ball_z are hardly determined one by one, only "
      "where the ball is; hold theta_{} and alpha_{}, or give priors",
      from_axis, free, before, before));
}

void JudgeHeldOut(double spread, double held_out, Calibration* calibration) {
  constexpr double kMuchMore = 1.5;
  if (held_out < kMuchMore * spread) return;
  calibration->warnings.push_back(fmt::format(
      "at the locations held out the ball strays by {:.3g} mm on average, {:.2g} times as far as where the robot was "
      "calibrated: the model lacks something there, and u does not hold it; calibrate with more locations of the tool",
      held_out, held_out / spread));
}

Result<std::unique_ptr<Scanner>> LoadFlangeBall(const Dataset& dataset) {
  SCANCAL_ASSIGN_OR_RETURN(FlangeBallDeclaration declaration, DeclareFlangeBall(dataset));
  SCANCAL_ASSIGN_OR_RETURN(std::vector<FlangeBall::Target> targets, ReadTools(declaration.targets, declaration));
  SCANCAL_ASSIGN_OR_RETURN(std::vector<FlangeBall::Target> check, ReadTools(declaration.check, declaration));
  return std::unique_ptr<Scanner>(
      std::make_unique<FlangeBallScanner>(std::move(declaration), std::move(targets), std::move(check)));
}

}  // namespace scancal
