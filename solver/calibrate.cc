#include "solver/calibrate.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include "solver/judge.h"
#include "solver/uncertainty/covariance.h"
#include "solver/uncertainty/coverage.h"
#include "solver/uncertainty/jackknife.h"
#include "solver/uncertainty/propagate.h"

namespace scancal {
namespace {

constexpr double kCoverage = 0.95;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRounding_mm = 1e-9;  // a pure error below this is none

double DataSumOfSquares(const Solution& solution, size_t target) {
  const LinearTarget& rows = solution.linear.targets[target];
  double sum = 0;
  for (size_t v = 0; v < solution.problem.targets[target].views.size(); ++v)
    if (solution.problem.targets[target].views[v].prior.empty())
      sum += rows.r.segment(rows.first[v], rows.first[v + 1] - rows.first[v]).squaredNorm();
  return sum;
}

double DataCount(const Target& target) {
  double count = 0;
  for (const Block& view : target.views)
    if (view.prior.empty()) count += view.rows->count();
  return count;
}

// Everything between views against everything within them (Draper and Smith, Applied Regression Analysis, 2.1).
LackOfFit TestFit(double sum_of_squares, double dof, const PureError& pure) {
  LackOfFit result;
  result.pure_error_sigma = pure.sigma();
  result.dof1 = dof - pure.dof;
  result.dof2 = pure.dof;
  if (result.dof1 < 1 || result.dof2 < 1 || !(result.pure_error_sigma > kRounding_mm)) {
    result.dof1 = result.dof2 = 0;
    return result;
  }
  const double between = std::max(0.0, sum_of_squares - pure.sum_of_squares) / result.dof1;
  result.F = between / (result.pure_error_sigma * result.pure_error_sigma);
  result.p = FUpperTail(result.F, result.dof1, result.dof2);
  return result;
}

// The headline: what the residuals show between views, and what cannot show there because all views share it.
Eigen::MatrixXd Headline(const Eigen::MatrixXd& clustered, const Budget& budget) {
  Eigen::MatrixXd total = clustered;
  for (const Contribution& line : budget.lines)
    if (!line.prior && (line.scope == Scope::kSystem || line.scope == Scope::kTarget)) total += line.covariance;
  return total;
}

std::vector<double> Plain(const Eigen::VectorXd& x) { return {x.data(), x.data() + x.size()}; }

void AddBudget(const Solution& solution, const Covariance& clustered, const Budget& budget, Calibration* result) {
  const auto add = [&](BudgetLine line, const Eigen::MatrixXd& covariance) {
    line.contribution = Plain(covariance.diagonal().cwiseSqrt());
    line.share = Plain(covariance.diagonal().cwiseQuotient(result->covariance.diagonal()));
    result->budget.push_back(line);
  };
  add({"residuals, clustered by view", 'A', Unit::kMm, result->sigma, {}, {}, {}, clustered.dof}, clustered.matrix);
  for (const Contribution& line : budget.lines)
    for (const Quantity& quantity : solution.problem.quantities)
      if (line.sensitivity.size() && quantity.Source() == line.source)
        add({line.source, 'B', quantity.unit, quantity.u, Plain(line.sensitivity), {}, {}, kInfinity}, line.covariance);
}

}  // namespace

double PureError::sigma() const { return dof > 0 ? std::sqrt(sum_of_squares / dof) : 0; }

Solution Solve(Problem problem, const Estimate& start, const RefineOptions& options) {
  Solution solution{std::move(problem), {}, {}, {}};
  solution.fit = Refine(solution.problem, start, options);
  solution.linear = Linearize(solution.problem, solution.fit.estimate, Storey::kViews);
  solution.observability = Observe(solution.problem, solution.linear);
  return solution;
}

Calibration Summarize(const Solution& solution, double sigma, const PureError& pure_error) {
  const Problem& problem = solution.problem;
  const std::vector<int> estimated = problem.With({Scope::kSystem}, Role::kEstimate);
  const Covariance naive = NaiveCovariance(problem, solution.linear);
  const Covariance clustered = ClusteredCovariance(problem, solution.linear);
  const Budget budget = Propagate(problem, solution.fit.estimate, solution.linear);
  const Jackknife jackknife = LeaveOneTargetOut(problem, solution.fit);

  Calibration result;
  result.covariance = Headline(clustered.matrix, budget);
  result.iterations = solution.fit.iterations;
  result.converged = solution.fit.converged;
  Eigen::Index e = 0;
  for (const Quantity& quantity : problem.quantities) {
    if (quantity.scope != Scope::kSystem) continue;
    Parameter& p = result.parameters.emplace_back();
    p.name = quantity.name;
    p.unit = quantity.unit;
    p.role = quantity.role;
    p.value = quantity.value;
    if (quantity.role == Role::kConsider) p.u = quantity.u;
    if (quantity.role != Role::kEstimate) continue;
    result.estimated.push_back(p.name);
    p.value = solution.fit.estimate.system[e];
    p.u = std::sqrt(result.covariance(e, e));
    p.u_naive = std::sqrt(naive.matrix(e, e));
    p.u_clustered = std::sqrt(clustered.matrix(e, e));
    if (jackknife.covariance.size()) p.u_jackknife = std::sqrt(jackknife.covariance(e, e));
    // What was declared is taken as known exactly: its share of the variance has infinitely many degrees of freedom
    // (Welch-Satterthwaite, GUM G.4).
    const double share = p.u_clustered * p.u_clustered / (p.u * p.u);
    p.dof = clustered.dof / (share * share);
    p.k = CoverageFactor(kCoverage, p.dof);
    p.U = p.k * p.u;
    result.weakest[p.name] = solution.observability.weakest[e];
    ++e;
  }
  result.condition = solution.observability.condition;

  double sum_of_squares = 0, count = 0;
  for (size_t t = 0; t < problem.targets.size(); ++t) {
    const double points = DataCount(problem.targets[t]);
    const double squares = DataSumOfSquares(solution, t) * sigma * sigma;
    TargetSummary& target = result.targets.emplace_back();
    target.name = problem.targets[t].name;
    target.points = points;
    target.rms = std::sqrt(squares / std::max(1.0, points));
    sum_of_squares += squares;
    count += points;
  }
  const double quantities = static_cast<double>(
      estimated.size() + problem.With({Scope::kTarget}, Role::kEstimate).size() * problem.targets.size());
  result.sigma = std::sqrt(sum_of_squares / std::max(1.0, count - quantities));
  result.lack_of_fit = TestFit(sum_of_squares, count - quantities, pure_error);
  AddBudget(solution, clustered, budget, &result);
  for (Eigen::Index t = 0; t < jackknife.estimates.rows(); ++t)
    result.jackknife.push_back(Plain(jackknife.estimates.row(t).transpose()));
  Judge(solution, jackknife, clustered.dof, &result);
  return result;
}

}  // namespace scancal
