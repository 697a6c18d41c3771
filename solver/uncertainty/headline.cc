#include "solver/uncertainty/headline.h"
#include <cmath>
#include <limits>
#include "solver/uncertainty/propagate.h"

namespace scancal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

BudgetLine Line(const std::string& source, char type, Unit unit, double u, const Eigen::VectorXd& sensitivity,
                const Eigen::MatrixXd& covariance, double dof) {
  return {source, type, unit, u, Plain(sensitivity), Plain(covariance.diagonal().cwiseMax(0).cwiseSqrt()), {}, dof};
}

BudgetLine Line(const Problem& problem, const Contribution& contribution, bool from_data, double dof) {
  for (const Quantity& quantity : problem.quantities) {
    const std::string& name = contribution.prior ? "prior of " + quantity.Source() : quantity.Source();
    if (name == contribution.source)
      return Line(contribution.source, from_data ? 'A' : 'B', quantity.unit, quantity.u, contribution.sensitivity,
                  contribution.covariance, dof);
  }
  return {};
}

void AddShares(Headline* headline) {
  for (BudgetLine& line : headline->budget)
    for (size_t k = 0; k < line.contribution.size(); ++k) {
      const auto e = static_cast<Eigen::Index>(k);
      line.share.push_back(std::pow(line.contribution[k], 2) / headline->covariance(e, e));
    }
}

Headline Weighted(const Problem& problem, const Variances& variances, const Budget& budget, Eigen::Index n) {
  Headline headline{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd(n), {}};
  std::vector<Eigen::VectorXd> shares(n, Eigen::VectorXd::Zero(std::ssize(variances.sources)));
  for (const Contribution& contribution : budget.lines) {
    headline.covariance += contribution.covariance;
    const double dof = contribution.prior ? kInfinity : variances.Dof(contribution.source);
    bool from_data = false;
    for (size_t s = 0; s < variances.sources.size(); ++s) {
      if (contribution.prior || variances.sources[s] != contribution.source) continue;
      from_data = true;
      for (Eigen::Index k = 0; k < n; ++k) shares[k][static_cast<Eigen::Index>(s)] = contribution.covariance(k, k);
    }
    headline.budget.push_back(Line(problem, contribution, from_data, dof));
    headline.budget.back().random = contribution.scope == Scope::kView || contribution.scope == Scope::kPoint;
  }
  for (Eigen::Index k = 0; k < n; ++k) headline.dof[k] = variances.Dof(shares[k], headline.covariance(k, k));
  return headline;
}

Headline Clustered(const Problem& problem, const Covariance& clustered, const Budget& budget, Eigen::Index n) {
  Headline headline{clustered.matrix, Eigen::VectorXd(n), {}};
  headline.budget.push_back(
      Line("residuals, clustered by view", 'A', Unit::kMm, 0, Eigen::VectorXd(), clustered.matrix, clustered.dof));
  for (const Contribution& contribution : budget.lines) {
    if (contribution.prior || (contribution.scope != Scope::kSystem && contribution.scope != Scope::kTarget)) continue;
    headline.covariance += contribution.covariance;
    headline.budget.push_back(Line(problem, contribution, false, kInfinity));
  }
  for (Eigen::Index k = 0; k < n; ++k)
    headline.dof[k] = clustered.dof * std::pow(headline.covariance(k, k) / clustered.matrix(k, k), 2);
  return headline;
}

}  // namespace

Headline HeadlineOf(const Solution& solution, const Covariance& clustered) {
  const Budget budget = Propagate(solution.problem, solution.fit.estimate, solution.linear);
  const Eigen::Index n = clustered.matrix.rows();
  Headline headline = solution.variances ? Weighted(solution.problem, *solution.variances, budget, n)
                                         : Clustered(solution.problem, clustered, budget, n);
  headline.covariance = (headline.covariance + headline.covariance.transpose().eval()) / 2;
  AddShares(&headline);
  return headline;
}

}  // namespace scancal
