// A model that is no scanner: points (x, y) of several straight lines that share a slope; for tests of the solver
// alone.
#pragma once
#include <cmath>
#include <string>
#include <vector>
#include "solver/model.h"
#include "solver/random.h"

namespace scancal {

// r = y - slope x - curvature x^2 - level - shift(view) - noise(point)
class LineModel {
 public:
  enum { kSlope, kCurvature, kLevel, kShift, kNoise };
  static constexpr int kRowsPerPoint = 1;
  struct View {
    std::vector<double> x, y;
  };
  struct Target {
    std::string name;
    std::vector<View> views;
  };
  LineModel()
      : quantities_{{"slope", Unit::kOne, Scope::kSystem, Role::kEstimate, 0, 0, false, ""},
                    {"curvature", Unit::kOne, Scope::kSystem, Role::kHold, 0, 0, false, ""},
                    {"level", Unit::kMm, Scope::kTarget, Role::kEstimate, 0, 0, false, ""},
                    {"shift", Unit::kMm, Scope::kView, Role::kHold, 0, 0, false, ""},
                    {"noise", Unit::kMm, Scope::kPoint, Role::kHold, 0, 0, false, ""}} {}
  const Quantities& quantities() const { return quantities_; }
  Quantity& quantity(int k) { return quantities_[k]; }
  int Points(const View& view) const { return static_cast<int>(view.x.size()); }
  double Count(const View& view) const { return static_cast<double>(view.x.size()); }
  template <class T>
  void Residual(const Target&, const View& view, const Seen<T>& q, T* r) const {
    for (int i = 0; i < Points(view); ++i)
      r[i] = view.y[i] - q[kSlope] * view.x[i] - q[kCurvature] * (view.x[i] * view.x[i]) - q[kLevel] - q[kShift] -
             q(i, kNoise);
  }

 private:
  Quantities quantities_;
};

struct LineScene {
  double slope = 0.3, curvature = 0, noise = 0.1, shift = 0;
  double shift_correlation = 0;  // of neighbouring views
  int targets = 3, views = 8, points = 5;
  uint64_t seed = 1;
  std::vector<LineModel::Target> Make() const {
    std::vector<LineModel::Target> result;
    Random random(seed, 0);
    for (int t = 0; t < targets; ++t) {
      LineModel::Target& target = result.emplace_back();
      target.name = "line " + std::to_string(t);
      double moved = 0;
      for (int v = 0; v < views; ++v) {
        LineModel::View& view = target.views.emplace_back();
        const double rho = v == 0 ? 0 : shift_correlation;
        moved = rho * moved + shift * std::sqrt(1 - rho * rho) * random.Normal();
        for (int i = 0; i < points; ++i) {
          const double x = 0.7 * v + 0.1 * i + 0.05 * t;
          view.x.push_back(x);
          view.y.push_back(slope * x + curvature * x * x + 10 * t + moved + noise * random.Normal());
        }
      }
    }
    return result;
  }
};

}  // namespace scancal
