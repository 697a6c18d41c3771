// Views resampled: an uncertainty that supposes no distribution.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include "solver/linearize.h"

namespace scancal {

struct Bootstrap {
  Eigen::MatrixXd covariance;  // of the system's quantities; empty with fewer than two replicates
  int replicates = 0;          // that determine all quantities; the others are left out
};

// Efron's bootstrap of pairs (Efron and Tibshirani 1993, 9.5): in every target as many views as it has are drawn with
// replacement, and the linearised problem
//
//     sum over views of m_v |r_v + J_v x|^2 + |priors|^2,   m_v: how often view v was drawn,
//
// is solved by QR of rows times sqrt(m_v). Priors are kept, once each; what they may themselves be wrong by is not in
// it. Right for any errors that are independent from view to view, as the clustered covariance is; with n views a
// target it is too small by about the part p / n that the quantities take, and it scatters by 1 / sqrt(2 replicates).
// Replicate k draws from stream k of the seed. linear: of the views, at the fit.
Bootstrap ResampleViews(const Problem& problem, const Linearization& linear, int replicates, uint64_t seed);

}  // namespace scancal
