// The uncertainty that is stated, and its budget.
#pragma once
#include <vector>
#include "solver/calibrate.h"

namespace scancal {

struct Headline {
  Eigen::MatrixXd covariance;  // of the system's estimated quantities
  Eigen::VectorXd dof;         // effective degrees of freedom of each variance (Welch-Satterthwaite, GUM G.4)
  std::vector<BudgetLine> budget;
};

// Weighted fits: K V K' with everything random, declared or estimated, and everything that was considered; the
// estimated variances are one block in the degrees of freedom. Equal weights: what the residuals show between views
// (clustered), and what cannot show there because views share it.
Headline HeadlineOf(const Solution& solution, const Covariance& clustered);

}  // namespace scancal
