// Ball centres in the robot's base, and what a calibration.json says of the robot.
#include "models/parts/calibrated_values.h"
#include "models/robot_ball/hand_eye.h"
#include "models/robot_ball/robot_scanner.h"

namespace scancal {
namespace {

Result<RobotSetup> SetupOf(const Calibration& calibration, size_t links) {
  RobotSetup setup;
  SCANCAL_ASSIGN_OR_RETURN(
      const Eigen::VectorXd hand_eye,
      ValuesOf(calibration, {"hand_eye_x", "hand_eye_y", "hand_eye_z", "hand_eye_rx", "hand_eye_ry", "hand_eye_rz"}));
  setup.flange_from_scanner = PoseOf(hand_eye);
  SCANCAL_ASSIGN_OR_RETURN(setup.link_errors, LinkErrorsOf(calibration, links));
  return setup;
}

}  // namespace

Result<int64_t> TransformRobot(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud) {
  SCANCAL_ASSIGN_OR_RETURN(const RobotDeclaration declaration, DeclareRobot(dataset));
  const RobotData& data = declaration.data;
  SCANCAL_ASSIGN_OR_RETURN(const RobotSetup setup, SetupOf(calibration, data.links.size()));
  int64_t points = 0;
  for (size_t t = 0; t < data.stations.size(); ++t) {
    std::vector<std::array<double, 3>> in_base;
    for (const RobotBall::View& pose : data.stations[t].views) {
      const Eigen::Isometry3d base_from_scanner = BaseFromScanner(data, setup, pose);
      for (const RobotBall::SeenBall& ball : pose.balls) {
        const Eigen::Vector3d p = base_from_scanner * ball.centre;
        in_base.push_back({p.x(), p.y(), p.z()});
      }
    }
    SCANCAL_RETURN_IF_ERROR(cloud->Write(in_base, static_cast<int>(t)));
    points += std::ssize(in_base);
  }
  return points;
}

Result<Propagation> PropagateRobot(const Calibration&, const PointRequest&, bool) {
  return Error{"propagate: expected a calibration of a turntable; the uncertainty of a robot's points is not in yet"};
}

}  // namespace scancal
