// A fit posed like a scanner, whose solver cannot tell the difference; and a function with its derivatives.
#pragma once
#include <ceres/jet.h>
#include <Eigen/Core>
#include <cmath>
#include <string>
#include <utility>
#include <vector>
#include "models/selftest/selftest.h"
#include "solver/model.h"
#include "solver/refine.h"
#include "solver/uncertainty/covariance.h"

namespace scancal::selftest {

// r = y - f(b, x). F: a function object T f(const T* b, const double* x) for every T; it has no state. Every
// observation is a view of its own, since nothing but the parameters b1, b2, ... is common to any two.
template <class F>
class Regression {
 public:
  static constexpr int kRowsPerPoint = 1;
  using View = Observation;
  struct Target {
    std::string name;
    std::vector<View> views;
  };
  explicit Regression(const std::vector<double>& start) {
    for (const double value : start)
      quantities_.push_back({"b" + std::to_string(quantities_.size() + 1), Unit::kOne, Scope::kSystem, Role::kEstimate,
                             value, 0, false, ""});
  }
  const Quantities& quantities() const { return quantities_; }
  int Points(const View&) const { return 1; }
  double Count(const View&) const { return 1; }
  template <class T>
  void Residual(const Target&, const View& view, const Seen<T>& q, T* r) const {
    r[0] = view.y - F()(q.q, view.x.data());
  }

 private:
  Quantities quantities_;
};

template <class F>
Problem PoseRegression(const std::vector<double>& start, std::vector<Observation> observations) {
  return MakeProblem<Regression<F>>(std::make_shared<Regression<F>>(start), {{"data", std::move(observations)}});
}

struct LeastSquares {
  Fit fit;
  Covariance covariance;
};

// The very code that calibrates scanners: refinement, linearization at the fit, naive covariance.
inline LeastSquares SolveLeastSquares(const Problem& problem, const RefineOptions& options = {}) {
  LeastSquares result;
  result.fit = Refine(problem, NominalStart(problem), options);
  result.covariance = NaiveCovariance(problem, Linearize(problem, result.fit.estimate, Storey::kViews));
  return result;
}

// A measurement function and its derivatives at an estimate.
template <int kOutputs, int kInputs>
struct Evaluated {
  Eigen::Vector<double, kOutputs> y;
  Eigen::Matrix<double, kOutputs, kInputs> sensitivity;  // dy/dx
};

// f(const T* x, T* y), by dual numbers.
template <int kOutputs, int kInputs, class F>
Evaluated<kOutputs, kInputs> Evaluate(const F& f, const Eigen::Vector<double, kInputs>& x) {
  using Jet = ceres::Jet<double, kInputs>;
  Jet in[kInputs], out[kOutputs];
  for (int k = 0; k < kInputs; ++k) in[k] = Jet(x[k], k);
  f(in, out);
  Evaluated<kOutputs, kInputs> result;
  for (int i = 0; i < kOutputs; ++i) {
    result.y[i] = out[i].a;
    result.sensitivity.row(i) = out[i].v.transpose();
  }
  return result;
}

}  // namespace scancal::selftest
