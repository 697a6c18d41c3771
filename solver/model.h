// The contract of a model, and the only template of the solver: MakeProblem.
#pragma once
#include <ceres/jet.h>
#include <algorithm>
#include <concepts>
#include <type_traits>
#include "solver/problem.h"

namespace scancal {

// What a view sees: one number per quantity. Scope decides who else sees the same number; the model need not care.
template <class T>
struct Seen {
  const T* q;
  const double* point;  // points x count, values of point scope; null: zero
  int count;
  const T& operator[](int k) const { return q[k]; }
  T operator()(int i, int k) const { return point ? q[k] + point[i * count + k] : q[k]; }  // as point i sees it
};

// Neither a value nor a derivative: what multiplies it need not be computed.
template <class T>
bool IsZero(const T& x) {
  if constexpr (std::is_same_v<T, double>) return x == 0;
  else return x.a == 0 && x.v.isZero(0);
}

// No derivative: what multiplies it is a plain number.
template <class T>
bool IsConstant(const T& x) {
  if constexpr (std::is_same_v<T, double>) return true;
  else return x.v.isZero(0);
}
template <class T>
double ValueOf(const T& x) {
  if constexpr (std::is_same_v<T, double>) return x;
  else return x.a;
}

// A model declares one list of quantities and one residual. Residuals are signed, smooth, pure, and written in the
// frame where the noise lives.
template <class M>
concept ScannerModel = requires(const M m, const typename M::Target t, const typename M::View v, Seen<double> q,
                                double* r) {
  { m.quantities() } -> std::convertible_to<const Quantities&>;
  { t.name } -> std::convertible_to<std::string>;
  { t.views } -> std::convertible_to<const std::vector<typename M::View>&>;
  { m.Points(v) } -> std::same_as<int>;
  { m.Count(v) } -> std::convertible_to<double>;  // observations behind the points
  { M::kRowsPerPoint } -> std::convertible_to<int>;
  m.Residual(t, v, q,
             r);  // template <class T> void Residual(const Target&, const View&, const Seen<T>&, T* rows) const
};

// Optional: the derivatives in closed form, where dual numbers would be what a user waits for. As Rows::Evaluate for
// these views of the target, one after the other.
template <class M>
concept HasJacobian = ScannerModel<M> &&
    requires(const M m, const typename M::Target t, std::span<const typename M::View> views, Seen<double> q,
             std::span<const int> seeds, double* r) {
  m.Jacobian(t, views, q, seeds, r, r);
};

// Views made up by a model that stand for the next few of a target's.
template <class View>
struct StandIns {
  std::vector<View> nodes;
  size_t views = 0;
};

// Optional: a second, coarser storey of compression (see Target::nodes). None: not for this target.
template <class M>
concept HasNodes = ScannerModel<M> && requires(const M m, const typename M::Target t, const typename M::View v) {
  { m.MakeNodes(t) } -> std::same_as<std::vector<StandIns<typename M::View>>>;
  { m.Interpolate(std::vector{v}, v) } -> std::convertible_to<Eigen::MatrixXd>;  // as in Target::interpolation
};

// Residuals of some views of one target, differentiated in closed form, or else forwards by dual numbers of a fixed
// width (Griewank and Walther, Evaluating Derivatives, 2008, ch. 3; Jet of Ceres).
template <ScannerModel M>
class ModelRows final : public Rows {
 public:
  using View = typename M::View;
  // owner: of the views. part_of, first: see PartOf.
  ModelRows(std::shared_ptr<const M> model, std::shared_ptr<const typename M::Target> target,
            std::shared_ptr<const void> owner, std::span<const View> views,
            std::shared_ptr<const Rows> part_of = nullptr, int first = 0)
      : model_(std::move(model)),
        target_(std::move(target)),
        owner_(std::move(owner)),
        views_(views),
        part_of_(std::move(part_of)),
        first_(first) {
    for (const auto& view : views_) {
      points_ += model_->Points(view);
      count_ += model_->Count(view);
    }
  }
  int size() const override { return points_ * M::kRowsPerPoint; }
  int points() const override { return points_; }
  double count() const override { return count_; }

  void Evaluate(const double* q, const double* point, std::span<const int> seeds, double* r,
                double* jacobian) const override {
    const int quantities = static_cast<int>(model_->quantities().size());
    if (!jacobian) return Call(Seen<double>{q, point, quantities}, r);
    if constexpr (HasJacobian<M>) {
      model_->Jacobian(*target_, views_, Seen<double>{q, point, quantities}, seeds, r, jacobian);
    } else {
      EvaluateByJets(q, point, quantities, seeds, r, jacobian);
    }
  }
  std::pair<const Rows*, int> PartOf() const override { return {part_of_.get(), first_}; }

 private:
  void EvaluateByJets(const double* q, const double* point, int quantities, std::span<const int> seeds, double* r,
                      double* jacobian) const {
    constexpr int kWidth = 8;
    using Jet = ceres::Jet<double, kWidth>;
    std::vector<Jet> x(q, q + quantities), rows(size());
    for (size_t first = 0; first < seeds.size(); first += kWidth) {
      const auto now = seeds.subspan(first, std::min<size_t>(kWidth, seeds.size() - first));
      for (int k = 0; k < std::ssize(now); ++k) x[now[k]].v[k] = 1;
      Call(Seen<Jet>{x.data(), point, quantities}, rows.data());
      for (const int k : now) x[k].v.setZero();
      for (size_t i = 0; i < rows.size(); ++i) {
        r[i] = rows[i].a;
        for (int k = 0; k < std::ssize(now); ++k) jacobian[(first + k) * rows.size() + i] = rows[i].v[k];
      }
    }
  }

  template <class T>
  void Call(Seen<T> q, T* r) const {
    for (const View& view : views_) {
      model_->Residual(*target_, view, q, r);
      r += model_->Points(view) * M::kRowsPerPoint;
      if (q.point) q.point += model_->Points(view) * q.count;
    }
  }

  std::shared_ptr<const M> model_;
  std::shared_ptr<const typename M::Target> target_;
  std::shared_ptr<const void> owner_;
  std::span<const View> views_;
  std::shared_ptr<const Rows> part_of_;
  int first_;
  int points_ = 0;
  double count_ = 0;
};

// The estimation problem of a model and its targets: behind this line nothing is a template. Rows have unit weight.
template <ScannerModel M>
Problem MakeProblem(const std::shared_ptr<const M>& model, std::vector<typename M::Target> targets) {
  Problem problem{model->quantities(), {}, {}};
  for (auto& each : targets) {
    const auto shared = std::make_shared<const typename M::Target>(std::move(each));
    Target& target = problem.targets.emplace_back();
    target.name = shared->name;
    using View = typename M::View;
    const std::span<const View> views = shared->views;
    const auto all = std::make_shared<ModelRows<M>>(model, shared, shared, views);
    for (size_t v = 0, row = 0; v < views.size(); ++v) {
      const auto rows =
          std::make_shared<ModelRows<M>>(model, shared, shared, views.subspan(v, 1), all, static_cast<int>(row));
      row += static_cast<size_t>(rows->size());
      target.views.push_back({rows, 1, {}, {}, {}});
    }
    if constexpr (HasNodes<M>) {
      size_t view = 0;
      for (auto& [nodes, stand_for] : model->MakeNodes(*shared)) {
        const auto made = std::make_shared<const std::vector<View>>(std::move(nodes));
        target.nodes.push_back({std::make_shared<ModelRows<M>>(model, shared, made, *made), 1, {}, {}, {}});
        auto& interpolation = target.interpolation.emplace_back();
        for (const size_t end = view + stand_for; view < end; ++view)
          interpolation.push_back(model->Interpolate(*made, views[view]));
      }
    }
  }
  problem.AddPriors();
  problem.WeighEqually(1);
  return problem;
}

}  // namespace scancal
