// Measured ball centres corrected by what a CMM knows of the artifact: eqs. (8)-(20) of Zhou et al. 2025.
#pragma once
#include <Eigen/Core>
#include <vector>
#include "models/robot_ball/measured.h"

namespace scancal {

struct CentreAdjustment {
  Eigen::Matrix3Xd centres;  // corrected, mm
  int iterations = 0;
  bool converged = false;
};

// Conditional adjustment, eqs. (8)-(15): of all dX with A dX + l = 0 (every distance of two balls is the CMM's) the one
// with the least dX' P dX, by Lagrange multipliers
//
//     dX = -P^-1 A' (A P^-1 A')^+ l,    l = f(X_k) + A (X_0 - X_k),
//
// re-linearised at X_k = X_0 + dX until dX stands still. measured: X_0, and on_artifact: where the balls are known to
// be, both 3 x n, mm. spreads: S of each ball, P^-1 = blockdiag(S S'). The pseudo-inverse, because n balls give
// n (n-1) / 2 distances of which 3 n - 6 are independent; of A S, not of its square.
//
// With S = 1 it converges to the artifact fitted rigidly to the measured centres: it takes the balls' own errors of
// distance and angle away, and no error of the pose. Balls in a plane or on a line: the distances do not see what is
// across to first order, and convergence is slow.
CentreAdjustment AdjustByDistances(const Eigen::Matrix3Xd& measured, const Eigen::Matrix3Xd& on_artifact,
                                   const std::vector<Eigen::Matrix3d>& spreads, int most_iterations = 100);

// Angle conditions, eqs. (16)-(20): B dX = d, d = known minus measured angle at a ball between two others, for all
// triples; one step, by ridge estimation, min |B dX - d|^2 + k |dX|^2. The paper does not say how large k is: here
// sqrt(k) is 1e-3 of the largest singular value of B. Weights are one. After AdjustByDistances d = 0, and so is dX.
Eigen::Matrix3Xd AdjustByAngles(const Eigen::Matrix3Xd& measured, const Eigen::Matrix3Xd& on_artifact);

// Both, on every pose of every station; a pose with one ball stays as it is.
RobotData AdjustCentres(RobotData data);

}  // namespace scancal
