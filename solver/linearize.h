// A problem at an estimate, as matrices, with every target's own quantities eliminated by QR.
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>
#include "solver/problem.h"

namespace scancal {

enum class Storey { kViews, kNodes };

// J = [own, system] of one target = [Q 0; coupling] by QR: own = Q R, system = Q coupling + system_left, Q' system_left
// = 0.
struct LinearTarget {
  std::vector<Eigen::Index> first;  // first row of each block, then the number of rows
  Eigen::VectorXd r;                // residuals
  Eigen::MatrixXd q;                // rows x own, orthonormal
  Eigen::MatrixXd own_factor;       // own x own, upper triangular R
  Eigen::MatrixXd coupling;         // own x system
  Eigen::MatrixXd system_left;      // rows x system
  bool own_determined = true;       // R has full rank
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

// The step that minimises the linearised sum of squares. Not finite where a quantity is not determined.
Estimate GaussNewtonStep(const Linearization& linear);
void Add(const Estimate& step, Estimate* x);

}  // namespace scancal
