// What the model leaves out, asked of the residuals.
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>
#include "solver/linearize.h"

namespace scancal {

// A source of system or target scope that was not estimated (held, or considered with its u), tested for what the
// residuals say of it (score test; Rao 1948): with B its columns dr/dq, free of what the estimated quantities explain,
// m = -(B'B)^-1 B'r is what a fit would give it; its covariance is (B'B)^-1 from the noise, and what everything that
// was considered, itself among it, makes of m.
struct Misfit {
  std::string source;
  bool considered = false;  // with a u; else held
  Unit unit = Unit::kOne;
  double size = 0;                   // m; of several instances the rms that is not explained
  double F = 0, dof1 = 0, dof2 = 0;  // m' (cov m)^-1 m / dof1
  double p = 1;                      // for this source, among all that were tested (Bonferroni)
  Eigen::VectorXd moves;             // per system quantity: by how much a misfit of that size moves it
};

// Every testable source, in the order of the quantities. The problem is weighed with its noise; linear: of the views,
// at the fit. noise_dof: degrees of freedom of that noise.
std::vector<Misfit> TestMisfits(const Problem& problem, const Estimate& fit, const Linearization& linear,
                                double noise_dof);

}  // namespace scancal
