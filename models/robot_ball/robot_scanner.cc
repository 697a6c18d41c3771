#include "models/robot_ball/robot_scanner.h"
#include <fmt/format.h>
#include <chrono>
#include <cmath>
#include "io/progress.h"
#include "models/robot_ball/hand_eye.h"
#include "models/robot_ball/robot_figures.h"
#include "models/robot_ball/robot_fit.h"
#include "models/robot_ball/spacing.h"
#include "models/robot_ball/verdicts.h"
#include "models/robot_ball/virtual_point.h"

namespace scancal {
namespace {

void AddGeometry(const RobotFit& fit, Calibration* result) {
  result->frames["hand_eye"] = fit.Setup().flange_from_scanner.matrix();
  for (size_t t = 0; t < result->targets.size(); ++t) {
    const Eigen::Matrix<double, 6, 1> pose = NumbersOf(fit.BaseFromArtifact(t));
    result->targets[t].geometry = {{"base_from_artifact", {pose.data(), pose.data() + 6}}};
  }
}

void AddCheck(const RobotData& data, const RobotSetup& before, const RobotSetup& after, Calibration* result) {
  for (const CheckLength& length : data.check) {
    result->check.names.push_back(length.name);
    result->check.u.push_back(length.u);
  }
  result->check.before = SpacingErrors(data, before);
  result->check.after = SpacingErrors(data, after);
}

}  // namespace

Result<Calibration> RobotScanner::Calibrate(const RefineChoice& choice) const {
  if (!choice.residual.empty() && choice.residual != "depth")
    return Error{"residual: found \"" + choice.residual +
                 "\", but the residual of a robot is the ball centre's vector"};
  if (choice.equal_weights)
    return Error{
        "weights: found equal, but the balls of a pose share its repeatability: they cannot be weighed equally"};
  const RobotData& data = declaration_.data;
  SCANCAL_ASSIGN_OR_RETURN(const RobotSetup start, InitialHandEye(data));
  const auto began = std::chrono::steady_clock::now();
  SCANCAL_ASSIGN_OR_RETURN(const RobotFit fit,
                           FitRobot(data, model_, start.flange_from_scanner, choice.max_iterations));
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;

  Calibration result = Summarize(fit.solution, {});
  Progress progress("Monte Carlo");
  AddResampling(
      fit.solution, choice.monte_carlo, [&](double done) { progress.Show(done); }, &result);
  result.model = kRobotBall.name;
  result.name = declaration_.dataset.name;
  result.residual = "ball centre";
  result.seconds = seconds.count();
  AddGeometry(fit, &result);
  AddRobotFigures(data, fit, &result);
  SCANCAL_ASSIGN_OR_RETURN(const RobotSetup before, VirtualPointHandEye(data));
  AddCheck(data, before, fit.Setup(), &result);
  JudgeRobot(data, fit, &result);
  result.warnings.insert(result.warnings.begin(), declaration_.warnings.begin(), declaration_.warnings.end());
  return result;
}

Result<void> RobotScanner::WriteSurface(const std::filesystem::path&) const {
  return Error{"a robot's calibration searches no grid; it is for turntables"};
}

std::string RobotScanner::Describe() const {
  const Dataset& dataset = declaration_.dataset;
  const RobotData& data = declaration_.data;
  size_t poses = 0, balls = 0;
  for (const Station& station : data.stations) {
    poses += station.views.size();
    for (const RobotBall::View& pose : station.views) balls += pose.balls.size();
  }
  const std::string arm =
      data.links.empty() ? "poses of the flange as given" : fmt::format("an arm of {} joints", data.links.size());
  return fmt::format(
      "{}: robot with a scanner, {}, lengths in {}, angles in {}; {} stations, {} poses, {} ball centres of an "
      "artifact "
      "of {} balls{}.",
      dataset.name.empty() ? dataset.file.parent_path().filename().string() : dataset.name, arm, dataset.units.length,
      dataset.units.angle, data.stations.size(), poses, balls, data.spheres.size(),
      data.check.empty() ? "" : fmt::format("; {} known lengths for a check", data.check.size()));
}

Result<std::unique_ptr<Scanner>> LoadRobot(const Dataset& dataset) {
  SCANCAL_ASSIGN_OR_RETURN(RobotDeclaration declaration, DeclareRobot(dataset));
  SCANCAL_ASSIGN_OR_RETURN(RobotBall model, DeclareModel(declaration));
  return std::unique_ptr<Scanner>(std::make_unique<RobotScanner>(std::move(declaration), std::move(model)));
}

}  // namespace scancal
