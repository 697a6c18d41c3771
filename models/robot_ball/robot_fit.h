// The joint refinement of hand-eye, link errors and artifact poses.
#pragma once
#include "io/result.h"
#include "models/robot_ball/measured.h"
#include "solver/calibrate.h"

namespace scancal {

struct RobotFit {
  std::vector<Station> stations;  // as they entered: the poses from which artifact_x .. _rz count
  Solution solution;
  RobotSetup Setup() const;
  Eigen::Isometry3d BaseFromArtifact(size_t station) const;
};

// Generalised least squares of all balls of all poses at once: rows are whitened per pose with V = blockdiag(balls) +
// sigma_r^2 1 1' (x) I3, because repeatability is common to all balls of a pose. sigma_r and the noise of the balls are
// as declared, or restricted maximum likelihood. model: carries roles, priors and the values of the links, estimated or
// held, that the fit starts from; hand_eye: where that starts; every station starts where its balls then lie
// (StationsAt).
//
// An Error names what the data do not determine.
Result<RobotFit> FitRobot(const RobotData& data, const RobotBall& model, const Eigen::Isometry3d& hand_eye,
                          int max_iterations = 100);

}  // namespace scancal
