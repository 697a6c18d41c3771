// What drawing anew says of a result: bootstrap over views and Monte Carlo, as numbers of its Calibration.
#pragma once
#include <cstdint>
#include <functional>
#include "solver/calibrate.h"

namespace scancal {

// Views resampled: an uncertainty that supposes no distribution.
struct Bootstrap {
  Eigen::MatrixXd covariance;  // of the system's quantities; empty with fewer than two replicates
  int replicates = 0;          // that determine all quantities; the others are left out
};

// Efron's bootstrap of pairs (Efron and Tibshirani, An Introduction to the Bootstrap, 1993, 9.5): in every target as
// many views as it has are drawn with replacement, and the linearised problem
//
//     sum over views of m_v |r_v + J_v x|^2 + |priors|^2,   m_v: how often view v was drawn,
//
// is solved by Cholesky of the views' products in a basis in which those of all are the identity. Priors are kept, once
// each; what they may themselves be wrong by is not in it. Right for any errors that are independent from view to view,
// as the clustered covariance is; with n views a target it is too small by about the part p / n that the quantities
// take, and it scatters by 1 / sqrt(2 replicates). Replicate k draws from stream k of the seed. linear: of the views,
// at the fit.
Bootstrap ResampleViews(const Problem& problem, const Linearization& linear, int replicates, uint64_t seed);

struct MonteCarloChoice {
  int64_t trials = 0;  // at two digits the most; 0: none
  uint64_t seed = 1;
  int digits = 1;   // significant digits of u at which value +- U is validated: 1 or 2
  int threads = 0;  // 0: one a core
};

// Adds u_bootstrap to every estimated parameter of what Summarize made of the solution and, if trials are asked for,
// the Monte Carlo summary with its verdict on value +- U; a FAIL is a warning too. Monte Carlo is for weighted
// solutions: only they say how large all noise is. progress: fraction done, of the Monte Carlo.
void AddResampling(const Solution& solution, const MonteCarloChoice& choice,
                   const std::function<void(double)>& progress, Calibration* result);

}  // namespace scancal
