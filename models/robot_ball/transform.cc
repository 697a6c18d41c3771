// Ball centres in the robot's base, and what a calibration.json says of the robot.
#include "models/robot_ball/hand_eye.h"
#include "models/robot_ball/robot_scanner.h"

namespace scancal {
namespace {

Result<RobotSetup> SetupOf(const Calibration& calibration, size_t links) {
  const auto value = [&](const std::string& name) {
    const Parameter* parameter = calibration.Find(name);
    return parameter ? parameter->value : 0;
  };
  for (const char* name : {"hand_eye_x", "hand_eye_rx"})
    if (!calibration.Find(name)) return Error{std::string("the calibration has no ") + name + "; is it of a robot?"};
  RobotSetup setup;
  Eigen::Matrix<double, 6, 1> numbers;
  numbers << value("hand_eye_x"), value("hand_eye_y"), value("hand_eye_z"), value("hand_eye_rx"), value("hand_eye_ry"),
      value("hand_eye_rz");
  setup.flange_from_scanner = PoseOf(numbers);
  for (size_t k = 1; k <= links; ++k) {
    const std::string number = std::to_string(k);
    setup.link_errors.push_back({value("theta_" + number), value("d_" + number), value("a_" + number),
                                 value("alpha_" + number), value("beta_" + number)});
  }
  if (calibration.Find("theta_" + std::to_string(links + 1)))
    return Error{"the calibration is of a robot with more joints than the " + std::to_string(links) +
                 " of the data set"};
  return setup;
}

}  // namespace

Result<int64_t> TransformRobot(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud) {
  if (calibration.model != kRobotBall.name)
    return Error{"the calibration is of model \"" + calibration.model + "\", the data set of \"" + dataset.model +
                 "\""};
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
