// The hand-eye and the artifact's poses in closed form, links as they are: where every other method starts.
#pragma once
#include <Eigen/Geometry>
#include <vector>
#include "io/result.h"
#include "models/robot_ball.h"

namespace scancal::robot_ball {

// base_from_flange(q; nominal + errors) flange_from_scanner, eqs. (1)-(2) of Zhou et al. 2025. No errors: nominal.
Eigen::Isometry3d BaseFromScanner(const Measurements& data, const Kinematics& setup, const Model::View& view);

// flange_from_scanner with nominal links, for any data set: no start, no poses that only translate, and a pose may see
// any number of balls. The model of all poses j and balls b of all stations s,
//
//     F_j (R c_jb + t) = N_s k_b + n_s,        F = base_from_flange, (R, t) = flange_from_scanner,
//
// is linear once R and N are any 3 x 3 matrices and F's translation has a factor of its own. n, N, t and that factor
// are projected out; what is left of R is the smallest singular vector, made the nearest rotation. Turns of the flange
// (A X = X B) and mere translations (eq. (7)) both count. Then t is linear (eq. (6)) with R known.
//
// Where the data set holds all of the hand-eye, it is as it says. Two reflectors of a tool leave its turn about the
// line through them open: of all the smallest turn.
//
// Errors: too few balls for an equation; poses that move too little, or disagree too much, to determine R; poses that
// do not turn, or turn about one axis, which leaves t open along it. The sentences name the stations.
//
// Not a least-squares estimate: R and N are rotations only afterwards. That costs little and needs no start.
Result<Kinematics> InitialHandEye(const Measurements& data);

// Only the translation, eq. (6), the rotation being known. Errors: poses that do not turn, or turn about one axis.
Result<Eigen::Vector3d> HandEyeTranslation(const Measurements& data, const Eigen::Matrix3d& rotation);

// The stations with base_from_artifact set: all balls of a station, carried into the base, fitted by the artifact
// (Umeyama 1991). Error: a station where the seen balls lie on a line.
Result<std::vector<Station>> StationsAt(const Measurements& data, const Kinematics& setup);

}  // namespace scancal::robot_ball
