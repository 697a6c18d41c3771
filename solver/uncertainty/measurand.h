// The uncertainty of what is computed from a calibration.
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>
#include "solver/calibration.h"

namespace scancal {

// Estimated quantities x and considered quantities q of the system together. To suppose q wrong by dq moves the
// estimate by s dq, s the sensitivity in the budget; hence (GUM F.1.2.3)
//
//     cov(x, x): of the calibration,   cov(x, q) = s u(q)^2,   var(q) = u(q)^2,   cov(q, q') = 0.
//
// A quantity that a result depends on directly and through x can so count twice or cancel. A source without one
// sensitivity (one value a target; several quantities of the system in one source) acts through x alone.
struct JointCovariance {
  std::vector<std::string> names;  // x, then q
  Eigen::MatrixXd matrix;          // names x names, in the units of the quantities
  Eigen::MatrixXd own;             // x x x: cov(x, x) without the parts of q
  Eigen::VectorXd dof;             // of each variance of own

  // In use, this quantity has another value than it had in the data, as uncertain as it was: a temperature.
  void Renew(const std::string& name);
};
JointCovariance JointOf(const Calibration& calibration);

struct MeasurandUncertainty {
  Eigen::MatrixXd covariance;  // of the components
  double dof = 0, k = 0;       // one k for all components
  Eigen::VectorXd U;           // k u of each component
  double U_max = 0;            // k sqrt(largest eigenvalue): in the direction that is known least
};

// Of f(x, q), by: df / d names, one row a component (JCGM 102, 6.2). Degrees of freedom after Welch-Satterthwaite
// (GUM G.4): `own` is one block with the smallest of its dof among the quantities that f depends on, what was
// considered is known exactly; of the components and the direction of U_max the smallest counts. First order: no
// measure for a distance that is hardly longer than its U.
MeasurandUncertainty UncertaintyOf(const JointCovariance& joint, const Eigen::MatrixXd& by);

}  // namespace scancal
