#include "solver/uncertainty/budget.h"
#include <algorithm>
#include <map>
#include <set>
#include "solver/uncertainty/covariance.h"
#include "solver/weigh.h"

namespace scancal {
namespace {

// Sums (J~' b u)(J~' b u)' per source; H^-1 on both sides turns it into K V K'.
class Meat {
 public:
  explicit Meat(Eigen::Index system) : system_(system) {}
  void Add(const std::string& source, Scope scope, const Eigen::MatrixXd& scores) {
    auto [it, fresh] = lines_.try_emplace(source, scope, Eigen::MatrixXd::Zero(system_, system_));
    it->second.first = std::min(it->second.first, scope);
    it->second.second += scores * scores.transpose();
    if (fresh) order_.push_back(source);
  }
  void AddAcross(const std::string& source, const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    lines_.at(source).second += a * b.transpose() + b * a.transpose();
  }
  void AddPrior(const std::string& name, Scope scope, const Eigen::MatrixXd& scores) {
    Add(name, scope, scores);
    priors_.insert(name);
  }
  Budget Between(const Eigen::MatrixXd& h_inverse) const {
    Budget budget;
    for (const std::string& source : order_) {
      const auto& [scope, meat] = lines_.at(source);
      budget.lines.push_back({source, scope, priors_.contains(source), h_inverse * meat * h_inverse, {}});
    }
    return budget;
  }

 private:
  Eigen::Index system_;
  std::map<std::string, std::pair<Scope, Eigen::MatrixXd>> lines_;
  std::vector<std::string> order_;
  std::set<std::string> priors_;
};

// A bound of both for every quantity: the one that is larger on the whole, and on its diagonal what it lacks.
Eigen::MatrixXd Worse(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::VectorXd of_a = a.diagonal().cwiseMax(1e-300), of_b = b.diagonal().cwiseMax(1e-300);
  const bool b_is_larger = of_b.cwiseQuotient(of_a).array().log().sum() > 0;
  Eigen::MatrixXd worse = b_is_larger ? b : a;
  worse.diagonal() = of_a.cwiseMax(of_b);
  return worse;
}

}  // namespace

Eigen::MatrixXd Budget::Total() const {
  Eigen::MatrixXd total;
  for (const Contribution& line : lines)
    total = total.size() ? Eigen::MatrixXd(total + line.covariance) : line.covariance;
  return total;
}

Budget BudgetOf(const Problem& problem, const Estimate& fit, const Linearization& linear) {
  const std::vector<int> influences =
      problem.With({Scope::kSystem, Scope::kTarget, Scope::kView, Scope::kPoint}, Role::kConsider);
  const Eigen::Index system = linear.factor.cols(), n = std::ssize(influences);
  const auto influence = [&](Eigen::Index k) -> const Quantity& { return problem.quantities[influences[k]]; };
  Meat meat(system), shared(system);
  Eigen::MatrixXd of_system = Eigen::MatrixXd::Zero(system, n);  // scores of what the whole system shares
  for (size_t t = 0; t < problem.targets.size(); ++t) {
    const LinearTarget& target = linear.targets[t];
    const std::vector<double> q = Values(problem, fit, t);
    Eigen::MatrixXd of_target = Eigen::MatrixXd::Zero(system, n);
    Eigen::MatrixXd before = Eigen::MatrixXd::Zero(system, n);  // sum of rho^distance times the views before
    for (size_t v = 0; v < problem.targets[t].views.size(); ++v) {
      const Block& view = problem.targets[t].views[v];
      const Eigen::MatrixXd left = target.system_left.middleRows(target.first[v], view.size()).transpose();
      if (!view.prior.empty()) {
        meat.AddPrior(view.prior, Scope::kTarget, left);
        continue;
      }
      const Eigen::MatrixXd weighted = view.WeightedFromLeft(left);
      const Eigen::MatrixXd b = RawDerivatives(view, q, influences);
      for (Eigen::Index k = 0; k < n; ++k) {
        const Quantity& quantity = influence(k);
        const Eigen::MatrixXd scores = weighted * Instances(b.col(k) * quantity.u, view.rows->points(), quantity.scope);
        if (quantity.scope == Scope::kView || quantity.scope == Scope::kPoint) {
          meat.Add(quantity.Source(), quantity.scope, scores);
          if (quantity.neighbour == 0) continue;
          before.col(k) *= quantity.neighbour;
          meat.AddAcross(quantity.Source(), before.col(k), scores);
          before.col(k) += scores;
        } else {
          of_target.col(k) += scores;
        }
      }
    }
    for (Eigen::Index k = 0; k < n; ++k)
      if (influence(k).scope == Scope::kTarget) meat.Add(influence(k).Source(), Scope::kTarget, of_target.col(k));
    of_system += of_target;
  }
  for (Eigen::Index k = 0; k < n; ++k)
    if (influence(k).scope == Scope::kSystem) meat.Add(influence(k).Source(), Scope::kSystem, of_system.col(k));
  for (Eigen::Index k = 0; k < n; ++k)
    if (influence(k).perhaps_shared) shared.Add(influence(k).Source(), Scope::kTarget, of_system.col(k));
  for (size_t p = 0; p < problem.priors.size(); ++p)
    meat.AddPrior(problem.priors[p].prior, Scope::kSystem,
                  linear.targets.back().system_left.row(static_cast<Eigen::Index>(p)).transpose());
  const Eigen::MatrixXd h_inverse = InverseInformation(linear);
  Budget budget = meat.Between(h_inverse);
  for (const Contribution& one : shared.Between(h_inverse).lines)
    for (Contribution& line : budget.lines)
      if (line.source == one.source && !line.prior) line.covariance = Worse(line.covariance, one.covariance);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Quantity& quantity = influence(k);
    const auto of_source = std::count_if(influences.begin(), influences.end(), [&](int other) {
      return problem.quantities[other].Source() == quantity.Source();
    });
    for (Contribution& line : budget.lines)
      if (of_source == 1 && quantity.scope == Scope::kSystem && quantity.u > 0 && line.source == quantity.Source())
        line.sensitivity = -h_inverse * of_system.col(k) / quantity.u;
  }
  return budget;
}

Eigen::MatrixXd SensitivitiesTo(const Problem& problem, const Estimate& fit, const Linearization& linear,
                                std::span<const int> quantities) {
  Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(linear.factor.cols(), std::ssize(quantities));
  for (size_t t = 0; t < problem.targets.size(); ++t) {
    const LinearTarget& target = linear.targets[t];
    const std::vector<double> values = Values(problem, fit, t);
    for (size_t v = 0; v < problem.targets[t].views.size(); ++v)
      if (const Block& view = problem.targets[t].views[v]; view.prior.empty())
        scores += target.system_left.middleRows(target.first[v], view.size()).transpose() *
                  view.Weighted(RawDerivatives(view, values, quantities));
  }
  return -InverseInformation(linear) * scores;
}

}  // namespace scancal
