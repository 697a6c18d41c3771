#include "solver/uncertainty/drawn_problem.h"
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

namespace scancal {
namespace {

constexpr double kLeastDof = 8;

double InverseChiSquared(double dof, Random* random) {  // scaled: mean dof / (dof - 2)
  return dof / boost::math::quantile(boost::math::chi_squared(dof), random->Uniform());
}

}  // namespace

// Rows at q + shift, each point at its own value.
class DrawnProblem::DrawnRows final : public Rows {
 public:
  DrawnRows(std::shared_ptr<const Rows> rows, size_t quantities)
      : shift(quantities), point(quantities * static_cast<size_t>(rows->points())), rows_(std::move(rows)) {}
  int size() const override { return rows_->size(); }
  int points() const override { return rows_->points(); }
  double count() const override { return rows_->count(); }
  void Evaluate(const double* q, const double*, std::span<const int> seeds, double* r,
                double* jacobian) const override {
    std::vector<double> drawn(shift);
    for (size_t k = 0; k < drawn.size(); ++k) drawn[k] += q[k];
    rows_->Evaluate(drawn.data(), point.data(), seeds, r, jacobian);
  }

  std::vector<double> shift, point;  // one per quantity; points x quantities

 private:
  std::shared_ptr<const Rows> rows_;
};

DrawnProblem::DrawnProblem(const Problem& problem, const Estimate& fit, const VarianceDof& variance_dof)
    : problem_(problem) {
  const auto considered = problem.With({Scope::kSystem, Scope::kTarget, Scope::kView, Scope::kPoint}, Role::kConsider);
  std::map<std::string, int> variances;
  for (const int k : considered) {
    const Quantity& q = problem.quantities[k];
    if (!(q.u > 0)) continue;
    const auto dof = variance_dof.find(q.Source());
    int variance = -1;
    if (dof != variance_dof.end() && std::isfinite(dof->second)) {
      const auto [it, fresh] = variances.try_emplace(q.Source(), static_cast<int>(variance_dof_.size()));
      if (fresh) variance_dof_.push_back(std::max(kLeastDof, dof->second));
      variance = it->second;
    }
    influences_.push_back({k, q.scope, q.u, variance, q.u});
  }
  for (size_t t = 0; t < problem_.targets.size(); ++t) {
    Target& target = problem_.targets[t];
    target.nodes = {};
    target.interpolation.clear();
    rows_.emplace_back();
    const std::vector<double> q = Values(problem, fit, t);
    for (Block& view : target.views) {
      RemoveResidual(q, &view);
      if (view.prior.empty()) view.rows = rows_.back().emplace_back(std::make_shared<DrawnRows>(view.rows, q.size()));
    }
  }
  for (Block& prior : problem_.priors) RemoveResidual(Values(problem, fit, 0), &prior);
}

void DrawnProblem::RemoveResidual(const std::vector<double>& q, Block* block) {
  Eigen::VectorXd r;
  block->Evaluate(q.data(), {}, &r, nullptr);
  if (block->offset.size() == 0) block->offset.setZero(r.size());
  block->offset -= r;
  if (!block->prior.empty()) priors_.push_back({block, block->offset});
}

void DrawnProblem::Draw(Random* random) {
  std::vector<double> variances;
  for (const double dof : variance_dof_) variances.push_back(InverseChiSquared(dof, random));
  for (Influence& influence : influences_)
    if (influence.variance >= 0) influence.drawn_u = influence.u * std::sqrt(variances[influence.variance]);
  const auto draw = [&](Scope scope, double* to) {
    for (const Influence& influence : influences_)
      if (influence.scope == scope) to[influence.quantity] = influence.drawn_u * random->Normal();
  };
  const size_t quantities = problem_.quantities.size();
  std::vector<double> drawn(quantities);
  draw(Scope::kSystem, drawn.data());
  for (const auto& target : rows_) {
    draw(Scope::kTarget, drawn.data());
    for (const std::shared_ptr<DrawnRows>& rows : target) {
      draw(Scope::kView, drawn.data());
      rows->shift = drawn;
      for (size_t i = 0; i < rows->point.size(); i += quantities) draw(Scope::kPoint, &rows->point[i]);
    }
  }
  for (const Prior& prior : priors_)
    for (Eigen::Index i = 0; i < prior.noiseless.size(); ++i)
      prior.block->offset[i] = prior.noiseless[i] - random->Normal();
}

}  // namespace scancal
