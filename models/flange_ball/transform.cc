// Where a calibrated robot has its ball.
#include "models/flange_ball/flange_ball_scanner.h"
#include "models/parts/calibrated_values.h"

namespace scancal {
namespace {

Result<RobotWithBall> CalibratedRobot(const std::vector<Link>& nominal, const Calibration& calibration) {
  SCANCAL_ASSIGN_OR_RETURN(const Eigen::VectorXd ball, ValuesOf(calibration, {"ball_x", "ball_y", "ball_z"}));
  SCANCAL_ASSIGN_OR_RETURN(const std::vector<Link> errors, LinkErrorsOf(calibration, nominal.size()));
  return RobotWithBall{WithErrors(nominal, errors), ball};
}

}  // namespace

Result<int64_t> TransformFlangeBall(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud) {
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
