// K V K': what every considered quantity contributes to the covariance of the estimate.
#pragma once
#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>
#include "solver/linearize.h"

namespace scancal {

struct Contribution {
  std::string source;
  Scope scope = Scope::kSystem;  // the widest of its quantities
  bool prior = false;            // of an estimated quantity
  Eigen::MatrixXd covariance;    // system x system
  Eigen::VectorXd sensitivity;  // d parameter / d quantity, for a source that is one quantity of the system; else empty
};

struct Budget {
  std::vector<Contribution> lines;  // priors are lines of their own
  Eigen::MatrixXd Total() const;
};

// With gain K = (J'J)^-1 J' (J whitened), each instance of a quantity of uncertainty u adds (K b)(K b)' u^2, b = dr/dq
// (GUM 5.1.2 eq. (10), instances being independent; for several outputs JCGM 102, 6.2.1.3). Instances: one for the
// system, one per target, per view, per point, as the scope says. Priors contribute their own unit noise. linear: of
// the views, at the fit.
Budget BudgetOf(const Problem& problem, const Estimate& fit, const Linearization& linear);

// d estimate / d q of quantities of system scope that were not estimated, one a column: -(J'J)^-1 J' dr/dq (GUM 5.1.3).
Eigen::MatrixXd SensitivitiesTo(const Problem& problem, const Estimate& fit, const Linearization& linear,
                                std::span<const int> quantities);

}  // namespace scancal
