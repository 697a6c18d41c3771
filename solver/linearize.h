// A problem at an estimate, as matrices, with every target's own quantities eliminated by QR; what the data determine.
#pragma once
#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>
#include "solver/problem.h"

namespace scancal {

inline constexpr double kRankTolerance = 1e-10;  // of what is left of a column, over the column

enum class Storey { kViews, kNodes };

// The rows of one target, J = [own, system], after QR of the part of its own quantities:
//
//     own = Q R,   system = Q coupling + system_left,   Q'Q = 1,   Q' system_left = 0,
//
// so that the minimum over its own quantities leaves system_left dx + (1 - Q Q') r for the system's (Golub and Pereyra
// 1973, variable projection; for linear rows Bjorck, Numerical Methods for Least Squares Problems, 1996, 6.3).
struct LinearTarget {
  std::vector<Eigen::Index> first;  // first row of each block, then the number of rows
  Eigen::VectorXd r;                // residuals
  Eigen::MatrixXd q;                // rows x own, orthonormal
  Eigen::MatrixXd own_factor;       // own x own, upper triangular R
  Eigen::MatrixXd coupling;         // own x system
  Eigen::MatrixXd system_left;      // rows x system
  bool own_determined = true;  // R has full rank: no column of own is a combination of the others to kRankTolerance
};

// Time and memory are linear in the views. The last entry of targets holds the priors of the system; it owns nothing.
struct Linearization {
  std::vector<LinearTarget> targets;
  Eigen::MatrixXd factor;       // system x system, upper triangular: |factor x| = |system_left x| over all targets
  Eigen::VectorXd rhs;          // system: factor x = -rhs is the Gauss-Newton step
  Eigen::VectorXd system_norm;  // norm of each system column before elimination
  double cost = 0;              // sum of squares of all residuals
};

// The rows at `values` (one per quantity), stacked block by block: r and its derivatives by the seeds.
void Stack(std::span<const Block> blocks, const std::vector<double>& values, std::span<const int> seeds,
           Eigen::VectorXd* r, Eigen::MatrixXd* jacobian, std::vector<Eigen::Index>* first = nullptr);

Linearization Linearize(const Problem& problem, const Estimate& at, Storey storey);

// The step dx that minimises |r + J dx|: factor dx = -rhs, then R dx_own = -Q'r - coupling dx. Not finite where a
// quantity is not determined.
Estimate GaussNewtonStep(const Linearization& linear);
void Add(const Estimate& step, Estimate* x);

// |J dx| of that step, the length of r projected on the columns of J: over the noise of one row it is the relative
// offset of Bates and Watts (1981, Technometrics 23, 179), which bounds how far each quantity moves in units of its u.
double StepLength(const Linearization& linear);

// Of the system's estimated quantities, after each target's own have been eliminated: singular values of `factor` with
// its columns scaled by their length before elimination, so that a value is the part of a quantity's effect that no
// target can imitate (scaled condition indices: Belsley, Kuh and Welsch, Regression Diagnostics, 1980, ch. 3).
struct Observability {
  Eigen::VectorXd singular;                       // descending
  double condition = 0;                           // largest / smallest singular value
  Eigen::VectorXd weakest;                        // unit vector of the least determined direction, scaled quantities
  std::vector<std::string> undetermined;          // system quantities in directions without effect
  std::vector<std::string> undetermined_targets;  // targets whose own quantities are not determined
};

Observability Observe(const Problem& problem, const Linearization& linear);

// Holds those of these estimated system quantities, in their order, of which less than `part` of the effect is left
// once all other estimated ones and those before them are taken out; returns their names. At the linearization's point.
std::vector<std::string> HoldUndetermined(std::span<const int> candidates, double part, const Linearization& linear,
                                          Problem* problem);

// The problem as it looks from one point, as cheap as that: r(q) = r(q0) + (dr/dq) (q - q0), q0 the values at `at`. For
// what changes the weights of a problem many times and its estimate hardly. Knows the derivatives of the estimated
// quantities and of all noise (view and point scope); the values of single points (Rows::Evaluate's `point`) it does
// not take. Views only, no nodes.
Problem Affine(const Problem& problem, const Estimate& at);

}  // namespace scancal
