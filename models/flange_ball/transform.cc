// Where a calibrated robot has its ball.
#include "models/flange_ball/flange_ball_scanner.h"

namespace scancal {
namespace {

// An Error where a parameter of the result is missing.
Result<RobotWithBall> CalibratedRobot(const std::vector<Link>& nominal, const Calibration& calibration) {
  RobotWithBall robot{nominal, {}};
  std::string missing;
  const auto value = [&](const std::string& name) {
    const Parameter* parameter = calibration.Find(name);
    if (!parameter) missing = name;
    return parameter ? parameter->value : 0.0;
  };
  robot.ball = {value("ball_x"), value("ball_y"), value("ball_z")};
  for (size_t k = 0; k < nominal.size(); ++k) {
    const std::string number = std::to_string(k + 1);
    Link& link = robot.links[k];
    link.theta += value("theta_" + number);
    link.d += value("d_" + number);
    link.a += value("a_" + number);
    link.alpha += value("alpha_" + number);
    link.beta += value("beta_" + number);
  }
  if (!missing.empty()) return Error{"the calibration has no parameter " + missing + ": is it of another robot?"};
  return robot;
}

}  // namespace

Result<int64_t> TransformFlangeBall(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud) {
  if (calibration.model != kFlangeBall.name)
    return Error{"the calibration is of model \"" + calibration.model + "\", the data set of \"" + dataset.model +
                 "\""};
  SCANCAL_ASSIGN_OR_RETURN(const FlangeBallDeclaration declaration, DeclareFlangeBall(dataset));
  SCANCAL_ASSIGN_OR_RETURN(const RobotWithBall robot, CalibratedRobot(declaration.model.links(), calibration));
  int64_t points = 0;
  int number = 0;
  for (const auto* tools : {&declaration.targets, &declaration.check}) {
    for (const ToolDeclaration& tool : *tools) {
      SCANCAL_ASSIGN_OR_RETURN(const FlangeBall::Target target, ReadTool(tool, declaration));
      std::vector<std::array<double, 3>> balls;
      for (const FlangeBall::View& view : target.views) {
        const Eigen::Vector3d p = robot.InBase(view.joints);
        balls.push_back({p.x(), p.y(), p.z()});
      }
      SCANCAL_RETURN_IF_ERROR(cloud->Write(balls, number++));
      points += std::ssize(balls);
    }
  }
  return points;
}

Result<Propagation> PropagateFlangeBall(const Calibration&, const PointRequest&, bool) {
  return Error{"propagate: the model flange-ball measures no points, expected the result of another model"};
}

}  // namespace scancal
