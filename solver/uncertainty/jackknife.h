// Leave one target out: which placement moves which parameter.
#pragma once
#include <Eigen/Core>
#include "solver/refine.h"

namespace scancal {

struct Jackknife {
  Eigen::MatrixXd estimates;  // targets x system: the fit without that target; empty with fewer than two targets
  Eigen::MatrixXd
      covariance;  // (m - 1)/m sum (x_i - mean)(x_i - mean)', m - 1 degrees of freedom: a diagnostic, no headline
  bool converged = true;
};

Jackknife LeaveOneTargetOut(const Problem& problem, const Fit& fit);

}  // namespace scancal
