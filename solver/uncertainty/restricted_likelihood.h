// The restricted likelihood of variances at one point: its slope and its curvature.
#pragma once
#include <Eigen/Core>
#include <vector>
#include "solver/problem.h"

namespace scancal {

// The unit effects of every unknown source on one view's rows, side by side; they hardly change with the estimate.
struct ViewEffects {
  std::vector<Eigen::MatrixXd> of_source;  // rows x instances, for u = 1
  std::vector<bool> of_points;             // acts on single points
};

// With P = V^-1 - V^-1 J (J'V^-1 J)^-1 J'V^-1 and V_k the covariance of source k for u = 1 (Patterson and Thompson
// 1971; Searle, Casella and McCulloch, Variance Components, 6.6). Time and memory are linear in the views.
class RestrictedLikelihood {
 public:
  // own, system: numbers of estimated quantities of one target, of the system.
  RestrictedLikelihood(Eigen::Index sources, size_t targets, Eigen::Index own, Eigen::Index system);
  // One view, whitened: residuals r (free of what the estimate explains) and its rows of an orthonormal basis of the
  // Jacobian, the target's own part and the system's. point_variance: what one row has from all its point noise.
  void Add(size_t target, const Block& view, const ViewEffects& effects, const Eigen::VectorXd& r,
           const Eigen::MatrixXd& own, const Eigen::MatrixXd& system, double point_variance);
  void Finish();  // after the last view

  const Eigen::VectorXd& score() const { return score_; }              // (r'P V_k P r - tr P V_k) / 2
  const Eigen::MatrixXd& information() const { return information_; }  // expected: tr(P V_k P V_l) / 2
  // For the last steps: the observed information where it is positive definite, else its average with the expected one
  // (Gilmour, Thompson and Cullis 1995).
  Eigen::MatrixXd Curvature() const;

 private:
  struct Projected {  // X' V_k X: of each target's own part of the basis, of the system's, and across
    std::vector<Eigen::MatrixXd> own, across;
    Eigen::MatrixXd system;
    double TraceOfProduct(const Projected& other) const;
  };

  Eigen::VectorXd score_;
  Eigen::MatrixXd information_, average_;  // average_: r'P V_k P V_l P r / 2
  std::vector<Eigen::MatrixXd> own_pull_;  // X' V_k P r
  Eigen::MatrixXd system_pull_;
  std::vector<Projected> projected_;
};

}  // namespace scancal
