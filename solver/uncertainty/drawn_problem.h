// A problem whose considered quantities have drawn values.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>
#include "solver/problem.h"
#include "solver/random.h"

namespace scancal {

// Source of a considered quantity whose u was estimated from the data -> degrees of freedom of that estimate.
using VarianceDof = std::map<std::string, double>;

// The data as the fit explains them, rows without their residuals, read with drawn quantities. In every view
//
//     residual(x) = weight mix (r(x, q + dq) - r(x_fit, q)),   dq ~ N(0, u^2),
//
// with one dq for the whole system, one per target, per view, per point, as the scope says; a prior becomes
// (x - x_fit) / u - N(0, 1). Weights are part of the estimator and stay what they were.
//
// JCGM 101, 5.2 and 7.4: the measurand is what the measurement function yields for a draw of its inputs, and here that
// is the estimate x(dq) from the one set of data, corrected by dq. Data made by dq and read as if it were zero would
// give x(-dq): the same to first order, but skewed to the other side. Noise is a quantity like the others.
//
// A u that was estimated from the data has a distribution too: u^2 is first drawn from the scaled inverse chi-squared,
// u^2 dof / chi2(dof), one draw for all quantities of a source (JCGM 101, 6.4.9.2). Below 8 degrees of freedom 8 are
// taken: a variance that the data hardly show has no usable chi-squared (its mean is infinite up to 2).
class DrawnProblem {
 public:
  DrawnProblem(const Problem& problem, const Estimate& fit, const VarianceDof& variance_dof);
  DrawnProblem(const DrawnProblem&) = delete;
  DrawnProblem& operator=(const DrawnProblem&) = delete;
  void Draw(Random* random);                           // a trial: everything anew
  const Problem& problem() const { return problem_; }  // views only: the nodes do not know the draws

 private:
  class DrawnRows;
  struct Influence {
    int quantity;
    Scope scope;
    double u;      // as declared or estimated
    int variance;  // which of variance_dof_; -1: known
    double drawn_u;
  };
  struct Prior {
    Block* block;  // of problem_
    Eigen::VectorXd noiseless;
  };
  void RemoveResidual(const std::vector<double>& q, Block* block);

  Problem problem_;
  std::vector<Influence> influences_;
  std::vector<double> variance_dof_;
  std::vector<std::vector<std::shared_ptr<DrawnRows>>> rows_;  // per target and view that is no prior
  std::vector<Prior> priors_;
};

}  // namespace scancal
