// From joint angles in memory to a calibrated robot with a ball, and how well the ball sits.
#pragma once
#include <Eigen/Core>
#include <vector>
#include "io/result.h"
#include "models/flange_ball.h"
#include "solver/calibrate.h"

namespace scancal::flange_ball {

struct Robot {
  std::vector<Link> links;
  Eigen::Vector3d ball = Eigen::Vector3d::Zero();  // in the flange's frame
  Eigen::Vector3d InBase(const std::vector<double>& joints) const { return BaseFromFlange(links, joints) * ball; }
  // Of a pose's socket: the mean over all poses in it.
  Eigen::Vector3d Socket(const Model::Target& tool, int socket) const;
};

// The links as they are, the ball by linear least squares: it shall stay where it is in each socket of each tool.
// For a robot whose last axis never turns one coordinate is arbitrary.
Robot FitBall(const std::vector<Link>& links, const std::vector<Model::Target>& tools);

// What a robot says of a tool, whether it was calibrated with it or not. Nothing is fitted.
struct Seating {
  double spread = 0;   // mean over the poses of |ball - its socket|, mm
  double spacing = 0;  // of the two sockets, mm
};
Seating SeatingOf(const Robot& robot, const Model::Target& tool);

// The joint fit of links, ball and sockets with equal weights, from what FitBall says of the model's nominal links. An
// Error names what these locations do not determine.
Result<Solution> FitJointly(const Model& model, std::vector<Model::Target> tools, int max_iterations = 100);

Robot RobotOf(const std::vector<Link>& nominal, const Solution& solution);

}  // namespace scancal::flange_ball
