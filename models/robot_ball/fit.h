// The joint refinement of hand-eye, link errors and artifact poses.
#pragma once
#include "io/result.h"
#include "models/robot_ball.h"
#include "solver/calibrate.h"

namespace scancal::robot_ball {

// values: one per quantity of the model.
Kinematics KinematicsOf(const std::vector<double>& values, size_t joints);

struct JointFit {
  std::vector<Station> stations;  // as they entered: the poses from which artifact_x .. _rz count
  Solution solution;
  std::vector<std::string> held;  // of what the joints do: was to be estimated, but these poses do not determine it
  std::vector<std::string> held_turn;  // of the hand-eye: two reflectors do not tell it, and it is held where it starts
  Kinematics Found() const;
  Eigen::Isometry3d BaseFromArtifact(size_t station) const;
};

// Whether the hand-eye's turn is told by a vector longer than half a turn, and the same turn told by one that is
// shorter: of any model whose first six quantities are the hand-eye. One with a prior, or held, is told as declared.
bool IsBeyondHalfATurn(const Solution& solution);
Estimate WithinHalfATurn(const Solution& solution);

// Generalised least squares of all balls of all poses at once: rows are whitened per pose with V = blockdiag(balls) +
// sigma_r^2 1 1' (x) I3, because repeatability is common to all balls of a pose. sigma_r and the noise of the balls are
// as declared, or restricted maximum likelihood. model: carries roles, priors and the values of the links, estimated or
// held, that the fit starts from; hand_eye: where that starts; every station starts where its balls then lie
// (StationsAt).
//
// An Error names what the data do not determine.
//
// equal_weights: all balls weigh alike, and no variance is estimated.
Result<JointFit> FitJointly(const Measurements& data, const Model& model, const Eigen::Isometry3d& hand_eye,
                            int max_iterations = 100, bool equal_weights = false);

struct Gauged {
  Kinematics setup;
  Eigen::Isometry3d base_from_true_base;  // the base that these numbers are told in
};

// The numbers that a calibration with the default roles of the links finds of a robot with these errors: theta_1 and
// d_1 go into the base, all of the last link into the hand-eye, d before a parallel axis into the next d. Every ball is
// seen as before; exact but for the last, where a beta before it is not zero (second order).
Gauged InDefaultGauge(const std::vector<Link>& nominal, const Kinematics& truth);

}  // namespace scancal::robot_ball
