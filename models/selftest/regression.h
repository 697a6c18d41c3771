// A curve through observations, posed like a scanner: the solver cannot tell the difference.
#pragma once
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>
#include "solver/model.h"
#include "solver/refine.h"
#include "solver/uncertainty/covariance.h"

namespace scancal {

struct Observation {
  double y = 0;
  std::array<double, 2> x = {};  // one or two predictors
};

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

}  // namespace scancal
