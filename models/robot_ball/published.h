// The published methods, and their steps: Zhou et al., Sensors 2025, 25, 4661, and the two that it compares with.
#pragma once
#include <Eigen/Core>
#include <vector>
#include "io/result.h"
#include "models/robot_ball.h"

namespace scancal::robot_ball {

// Measured centres corrected (eqs. (8)-(20), AdjustCentres), first hand-eye from virtual points (eqs. (5)-(7),
// VirtualPointHandEye), then hand-eye and link errors from distances (eqs. (21)-(32), IdentifyByDistances). Kept as a
// baseline: all distances weigh alike, and repeatability enters them unseen. Where all balls are of the same noise, it
// is no better than Mu2017 on simulated data (spacing errors within 5 %): the many distances average what the
// correction takes away. It is better where some balls are worse, and SeenBall::spread says so.
Result<Kinematics> Zhou2025(const Measurements& data);

// Mu et al., Opt. Eng. 2017, 56, 054103, as Zhou et al. 2025 compare with it: hand-eye and link errors from distances
// (IdentifyByDistances), the measured centres as they are: Zhou2025 without its correction.
Result<Kinematics> Mu2017(const Measurements& data);

// Ren, Yin, Zhu, Opt. Eng. 2012, 51, 114204, as Zhou et al. 2025 compare with it: the hand-eye from a single sphere,
// links nominal: of the sphere that one station sees most often, the centre stands still in the base. First from eqs.
// (6)-(7), or from all balls (InitialHandEye) where the one sphere is too little to start from; then the least squares
// of its scatter, which does not know the artifact.
//
// Error: no sphere is seen twice, or the poses do not move enough for a start.
Result<Kinematics> Ren2012(const Measurements& data);

// The virtual point, eq. (5): the data with one ball a pose, the barycentre of the four balls, or fewer, that all poses
// of its station see. Where no ball is seen in all poses, the poses that see the most seen ball have a point, and so on
// with the others: the station becomes several of its name.
Measurements VirtualPoints(const Measurements& data);

// The published first hand-eye, with nominal links, from the virtual points P_j. Poses of one orientation (within 1e-4
// rad) at a station only translate, by T_j - T_1 of the base: for them (eq. (7))
//
//     R_SE (P_1 - P_j) = R_E^-1 (T_j - T_1),
//
// differences to the mean in place of the first. R_SE is the rotation (det +1) that fits best, by SVD; two directions
// of movement suffice. T_SE follows by linear least squares, eq. (6), from the poses that turn.
//
// Few data sets hold poses that only translate; without them, or if they move along one line, InitialHandEye takes
// over, with all balls.
Result<Kinematics> VirtualPointHandEye(const Measurements& data);

// Measured ball centres corrected by what a CMM knows of the artifact: eqs. (8)-(20).
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
Measurements AdjustCentres(Measurements data);

enum class Identified { kHandEye, kHandEyeAndLinks };

// Hand-eye and link errors from distances in the base, eqs. (21)-(32): Levenberg-Marquardt (MINPACK's, by QR) over the
// hand-eye and the link errors that Model estimates by default, from `start`; what is held stays as it is there. Balls
// a and b seen from two poses of a station give (eq. (30))
//
//     |p_a - p_b| - l_ab,        l_ab the CMM's,
//
// p in the base; the same ball seen twice gives p_a - p_b, three numbers, for the norm has no derivative at zero. Pairs
// within one pose say nothing of the robot. All have one weight. Derivatives are exact (dual numbers through the
// chain).
//
// Pairs: each pose with the 16 that follow it at its station, the last with the first: up to 33 poses these are all
// pairs; and all their balls. Time and memory grow with poses x 16 x balls^2, 0.2 kB each.
//
// Errors: fewer distances than unknowns; no minimum reached. What the distances do not determine stays near the start.
// One distance enters many pairs, and they are not independent: not the best estimate, and no uncertainty comes of it.
Result<Kinematics> IdentifyByDistances(const Measurements& data, const Kinematics& start, Identified identified);

// The error of sphere spacings that took no part in the calibration, after VDI/VDE 2634-3: |p_a - p_b| in the base
// minus the CMM's distance, mm, one per Measurements::check.
std::vector<double> SpacingErrors(const Measurements& data, const Kinematics& setup);

}  // namespace scancal::robot_ball
