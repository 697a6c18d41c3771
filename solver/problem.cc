#include "solver/problem.h"
#include <algorithm>
#include "solver/dense.h"

namespace scancal {
namespace {

// A prior is a measurement like any other: the value of one quantity.
class PriorRow final : public Rows {
 public:
  PriorRow(int quantity, double value) : quantity_(quantity), value_(value) {}
  int size() const override { return 1; }
  int points() const override { return 1; }
  double count() const override { return 1; }
  void Evaluate(const double* q, const double*, std::span<const int> seeds, double* r,
                double* jacobian) const override {
    r[0] = q[quantity_] - value_;
    for (size_t k = 0; jacobian && k < seeds.size(); ++k) jacobian[k] = seeds[k] == quantity_;
  }

 private:
  int quantity_;
  double value_;
};

}  // namespace

const char* Name(Unit unit) { return unit == Unit::kMm ? "mm" : unit == Unit::kRad ? "rad" : "1"; }

const char* Name(Role role) {
  return role == Role::kEstimate ? "estimate" : role == Role::kConsider ? "consider" : "hold";
}

const char* Name(Scope scope) {
  return scope == Scope::kSystem   ? "system"
         : scope == Scope::kTarget ? "target"
         : scope == Scope::kView   ? "view"
                                   : "point";
}

int Find(const Quantities& quantities, const std::string& name) {
  const auto found = std::find_if(quantities.begin(), quantities.end(), [&](const auto& q) { return q.name == name; });
  return found == quantities.end() ? -1 : static_cast<int>(found - quantities.begin());
}

void Block::Evaluate(const double* q, std::span<const int> seeds, Eigen::VectorXd* r, Eigen::MatrixXd* jacobian) const {
  r->resize(rows->size());
  if (jacobian) jacobian->resize(rows->size(), std::ssize(seeds));
  rows->Evaluate(q, nullptr, seeds, r->data(), jacobian && !seeds.empty() ? jacobian->data() : nullptr);
  if (mix.size()) {
    *r = mix * *r;
    if (jacobian) *jacobian = mix * *jacobian;
  }
  if (weight != 1) {
    *r *= weight;
    if (jacobian) *jacobian *= weight;
  }
  if (offset.size()) *r += offset;
}

Eigen::MatrixXd Block::Weighted(const Eigen::Ref<const Eigen::MatrixXd>& rows_of_r) const {
  return mix.size() ? Eigen::MatrixXd(weight * mix * rows_of_r) : Eigen::MatrixXd(weight * rows_of_r);
}

Eigen::MatrixXd Block::WeightedFromLeft(const Eigen::Ref<const Eigen::MatrixXd>& left) const {
  return mix.size() ? Eigen::MatrixXd(weight * left * mix) : Eigen::MatrixXd(weight * left);
}

void Target::MixNodes() {
  size_t view = 0;
  for (size_t k = 0; k < nodes.size(); ++k) {
    const Eigen::Index size = nodes[k].rows->size(), columns = interpolation[k].front().cols();
    TriangularFactor factor(static_cast<int>(columns));
    for (const Eigen::MatrixXd& by : interpolation[k]) factor.Add(views[view++].Weighted(by));
    nodes[k].mix = factor.R().leftCols(size);
    if (columns > size) nodes[k].offset = factor.R().col(size);
  }
}

void Problem::AddPriors() { AddPriors(With({Scope::kSystem, Scope::kTarget}, Role::kEstimate)); }

void Problem::AddPriors(const std::vector<int>& of) {
  for (const int k : of) {
    const Quantity& q = quantities[k];
    if (q.u <= 0) continue;
    const Block prior{std::make_shared<PriorRow>(k, q.value), 1 / q.u, {}, {}, "prior of " + q.Source()};
    if (q.scope == Scope::kSystem) {
      priors.push_back(prior);
    } else {
      for (Target& target : targets) target.views.push_back(prior);
    }
  }
}

void Problem::WeighEqually(double sigma) {
  for (Target& target : targets) {
    for (Block& view : target.views) {
      if (!view.prior.empty()) continue;
      view.weight = 1 / sigma;
      view.mix.resize(0, 0);
    }
    target.MixNodes();
  }
}

std::vector<int> Problem::With(std::initializer_list<Scope> scopes, Role role) const {
  std::vector<int> found;
  for (int k = 0; k < std::ssize(quantities); ++k) {
    const Quantity& q = quantities[k];
    if (q.role == role && std::find(scopes.begin(), scopes.end(), q.scope) != scopes.end()) found.push_back(k);
  }
  return found;
}

bool Problem::NodesSuffice() const {
  // A target's own prior is a view that no node stands for.
  const bool stored = std::all_of(targets.begin(), targets.end(), [](const Target& t) {
    size_t views = 0;
    for (const auto& of_views : t.interpolation) views += of_views.size();
    return !t.nodes.empty() && t.views.size() == views;
  });
  return stored && std::all_of(quantities.begin(), quantities.end(), [](const Quantity& q) {
           return q.in_nodes || (q.role != Role::kEstimate && q.value == 0) || q.scope == Scope::kView ||
                  q.scope == Scope::kPoint;
         });
}

double Problem::Count() const {
  double count = static_cast<double>(priors.size());
  for (const Target& target : targets)
    for (const Block& view : target.views) count += view.rows->count();
  return count;
}

Estimate NominalStart(const Problem& problem) {
  const auto values = [&](Scope scope) {
    const std::vector<int> estimated = problem.With({scope}, Role::kEstimate);
    Eigen::VectorXd out(std::ssize(estimated));
    for (int k = 0; k < out.size(); ++k) out[k] = problem.quantities[estimated[k]].value;
    return out;
  };
  return {values(Scope::kSystem), std::vector<Eigen::VectorXd>(problem.targets.size(), values(Scope::kTarget))};
}

std::vector<double> Values(const Problem& problem, const Estimate& estimate, size_t target) {
  std::vector<double> q;
  for (const Quantity& quantity : problem.quantities) q.push_back(quantity.value);
  const std::vector<int> system = problem.With({Scope::kSystem}, Role::kEstimate);
  const std::vector<int> own = problem.With({Scope::kTarget}, Role::kEstimate);
  for (size_t k = 0; k < system.size(); ++k) q[system[k]] = estimate.system[static_cast<Eigen::Index>(k)];
  for (size_t k = 0; k < own.size(); ++k) q[own[k]] = estimate.targets[target][static_cast<Eigen::Index>(k)];
  return q;
}

void SetValues(const Problem& problem, const std::vector<double>& values, size_t target, Estimate* estimate) {
  const std::vector<int> system = problem.With({Scope::kSystem}, Role::kEstimate);
  const std::vector<int> own = problem.With({Scope::kTarget}, Role::kEstimate);
  for (size_t k = 0; k < system.size(); ++k) estimate->system[static_cast<Eigen::Index>(k)] = values[system[k]];
  for (size_t k = 0; k < own.size(); ++k) estimate->targets[target][static_cast<Eigen::Index>(k)] = values[own[k]];
}

}  // namespace scancal
