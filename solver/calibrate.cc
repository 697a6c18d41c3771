#include "solver/calibrate.h"
#include <algorithm>
#include <cmath>
#include "solver/dense.h"
#include "solver/uncertainty/budget.h"
#include "solver/uncertainty/gum.h"
#include "solver/uncertainty/jackknife.h"
#include "solver/uncertainty/misfit.h"
#include "solver/uncertainty/neighbours.h"

namespace scancal {
namespace {

constexpr Message<> kClusteredByView{"solver.clustered_by_view", "residuals, clustered by view",
                                     "Residuen, nach Ansichten gruppiert"};
constexpr Message<std::string_view> kPriorOf{"solver.prior_of", "prior of {}", "Vorwissen über {}"};

BudgetLine Line(const Sentence& source, char type, Unit unit, double u, const Eigen::VectorXd& sensitivity,
                const Eigen::MatrixXd& covariance, double dof) {
  return {source, type, unit, u, Plain(sensitivity), Plain(covariance.diagonal().cwiseMax(0).cwiseSqrt()), {}, dof};
}

BudgetLine Line(const Problem& problem, const Contribution& contribution, bool from_data, double dof) {
  for (const Quantity& quantity : problem.quantities) {
    const Sentence name = contribution.prior ? Say(kPriorOf, quantity.Source()) : Sentence{quantity.Source()};
    if (name.english == contribution.source)
      return Line(name, from_data ? 'A' : 'B', quantity.unit, quantity.u, contribution.sensitivity,
                  contribution.covariance, dof);
  }
  return {};
}

constexpr double kKnown_dof = 1e9;  // as good as infinitely many

constexpr Message<> kViewsScatter{"solver.views_scatter", "scatter of views beyond their noise",
                                  "Streuung der Ansichten über ihr Rauschen hinaus"};
constexpr Message<std::string_view, double, double> kViewsScatterMore{
    "solver.views_scatter_more",
    "{}: from view to view the residuals scatter {:.2g} times as much as noise and declarations explain (p = {:.1g}): "
    "views are not alike, or the model lacks something; u allows for it",
    "{}: Von Ansicht zu Ansicht streuen die Residuen {:.2g}-mal so stark, wie Rauschen und Angaben es erklären (p = "
    "{:.1g}): Die Ansichten sind nicht gleich gut, oder dem Modell fehlt etwas; u berücksichtigt dies"};

// What of the clustered covariance the headline lacks, if chance does not explain it.
void AddScatterOfViews(const Solution& solution, const Covariance& clustered, Headline* headline) {
  const Eigen::VectorXd dof = DofOfClusters(solution.problem, solution.linear);
  const Eigen::Index n = dof.size();
  double least = 1;
  Eigen::Index worst = 0;
  const auto ratio = [&](Eigen::Index k) { return clustered.matrix(k, k) / headline->covariance(k, k); };
  for (Eigen::Index k = 0; k < n; ++k) {
    if (!(dof[k] >= 1) || !(ratio(k) > 1)) continue;
    const double p =
        std::min(1.0, static_cast<double>(n) * FUpperTail(ratio(k), dof[k], std::min(headline->dof[k], kKnown_dof)));
    if (p < least) {
      least = p;
      worst = k;
    }
  }
  if (!(least < kSuspicious)) return;
  const Eigen::VectorXd u = headline->covariance.diagonal().cwiseSqrt();
  const SymmetricEigen eigen = EigenOf(u.cwiseInverse().asDiagonal() * (clustered.matrix - headline->covariance) *
                                       u.cwiseInverse().asDiagonal());
  const Eigen::MatrixXd lacking = u.asDiagonal() * eigen.vectors * eigen.values.cwiseMax(0).asDiagonal() *
                                  eigen.vectors.transpose() * u.asDiagonal();
  std::string which;
  Eigen::Index e = 0;
  for (const Quantity& quantity : solution.problem.quantities)
    if (quantity.scope == Scope::kSystem && quantity.role == Role::kEstimate && e++ == worst) which = quantity.name;
  headline->warnings.push_back(Say(kViewsScatterMore, which, std::sqrt(ratio(worst)), least));
  for (Eigen::Index k = 0; k < n; ++k) {  // Welch-Satterthwaite, GUM G.4
    const double before = headline->covariance(k, k), more = lacking(k, k);
    headline->dof[k] =
        std::pow(before + more, 2) / (before * before / headline->dof[k] + more * more / std::max(1.0, dof[k]));
  }
  headline->covariance += lacking;
  headline->budget.push_back(Line(Say(kViewsScatter), 'A', Unit::kMm, 0, Eigen::VectorXd(), lacking, dof.minCoeff()));
  headline->budget.back().random = true;
}

void AddShares(Headline* headline) {
  for (BudgetLine& line : headline->budget)
    for (size_t k = 0; k < line.contribution.size(); ++k) {
      const auto e = static_cast<Eigen::Index>(k);
      line.share.push_back(std::pow(line.contribution[k], 2) / headline->covariance(e, e));
    }
}

Headline Weighted(const Problem& problem, const Variances& variances, const Budget& budget, Eigen::Index n) {
  Headline headline{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd(n), {}, {}};
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
  Headline headline{clustered.matrix, Eigen::VectorXd(n), {}, {}};
  headline.budget.push_back(
      Line(Say(kClusteredByView), 'A', Unit::kMm, 0, Eigen::VectorXd(), clustered.matrix, clustered.dof));
  for (const Contribution& contribution : budget.lines) {
    if (contribution.prior || (contribution.scope != Scope::kSystem && contribution.scope != Scope::kTarget)) continue;
    headline.covariance += contribution.covariance;
    headline.budget.push_back(Line(problem, contribution, false, kInfinity));
  }
  for (Eigen::Index k = 0; k < n; ++k)
    headline.dof[k] = clustered.dof * std::pow(headline.covariance(k, k) / clustered.matrix(k, k), 2);
  return headline;
}

constexpr double kRounding_mm = 1e-9;  // a pure error below this is none

double DataSumOfSquares(const Solution& solution, size_t target) {
  double sum = 0;
  for (const Eigen::VectorXd& r : ResidualsOf(solution, target)) sum += r.squaredNorm();
  return sum;
}

double DataCount(const Target& target) {
  double count = 0;
  for (const Block& view : target.views)
    if (view.prior.empty()) count += view.rows->count();
  return count;
}

// Everything between views against everything within them (Draper and Smith, Applied Regression Analysis, 1998, 2.1).
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

void AddParameters(const Solution& solution, const Headline& headline, const Covariance& clustered,
                   const Jackknife& jackknife, Calibration* result) {
  Eigen::Index e = 0;
  for (const Quantity& quantity : solution.problem.quantities) {
    if (quantity.scope != Scope::kSystem) continue;
    Parameter& p = result->parameters.emplace_back();
    p.name = quantity.name;
    p.unit = quantity.unit;
    p.role = quantity.role;
    p.value = quantity.value;
    p.source = quantity.Source();
    p.determined = quantity.role == Role::kConsider ? "considered" : "held";
    if (quantity.role == Role::kConsider) p.u = quantity.u;
    if (quantity.role != Role::kEstimate) continue;
    p.prior = quantity.value;
    p.prior_u = quantity.u;
    result->estimated.push_back(p.name);
    p.value = solution.fit.estimate.system[e];
    p.u = std::sqrt(headline.covariance(e, e));
    p.determined = quantity.u > 0 && p.u * p.u > quantity.u * quantity.u / 2 ? "prior" : "data";
    p.u_naive = std::sqrt(solution.naive.matrix(e, e));
    p.u_clustered = std::sqrt(clustered.matrix(e, e));
    if (jackknife.covariance.size()) p.u_jackknife = std::sqrt(jackknife.covariance(e, e));
    p.dof = headline.dof[e];
    p.k = CoverageFactor(kCoverage, p.dof);
    p.U = p.k * p.u;
    result->weakest[p.name] = solution.observability.weakest[e];
    ++e;
  }
  const double n = static_cast<double>(e);
  if (e > 0) result->joint = {JointCoverageFactor(kCoverage, n, headline.dof.minCoeff()), headline.dof.minCoeff()};
}

void AddTargets(const Solution& solution, const PureError& pure_error, Calibration* result) {
  const Problem& problem = solution.problem;
  double sum_of_squares = 0, count = 0;
  for (size_t t = 0; t < problem.targets.size(); ++t) {
    const double points = DataCount(problem.targets[t]), squares = DataSumOfSquares(solution, t);
    TargetSummary& target = result->targets.emplace_back();
    target.name = problem.targets[t].name;
    target.points = points;
    target.rms = std::sqrt(squares / std::max(1.0, points));
    sum_of_squares += squares;
    count += points;
  }
  const double dof = count - QuantityCount(problem);
  result->sigma = std::sqrt(sum_of_squares / std::max(1.0, dof));
  result->lack_of_fit = TestFit(sum_of_squares, dof, pure_error);
}

bool IsInfluence(const Quantity& quantity) {
  const bool of_target_with_prior = quantity.scope == Scope::kTarget && quantity.u > 0;
  const bool random = quantity.scope == Scope::kView || quantity.scope == Scope::kPoint;
  return quantity.role != Role::kEstimate || of_target_with_prior || random;
}

void AddInfluences(const Solution& solution, Calibration* result) {
  std::map<std::string, std::pair<double, double>> squares;  // source -> sum, count
  for (const Quantity& quantity : solution.problem.quantities) {
    if (!IsInfluence(quantity)) continue;
    auto& [sum, count] = squares[quantity.Source()];
    if (count++ == 0)
      result->influences.push_back({quantity.Source(), quantity.unit, quantity.scope, quantity.role, 0});
    if (quantity.role != Role::kHold) sum += quantity.u * quantity.u;
  }
  for (Influence& influence : result->influences) {
    const auto& [sum, count] = squares[influence.source];
    influence.u = std::sqrt(sum / count);
    if (!solution.variances) continue;
    const auto& from_data = solution.variances->sources;
    if (std::find(from_data.begin(), from_data.end(), influence.source) != from_data.end())
      influence.role = Role::kEstimate;
  }
}

}  // namespace

Headline HeadlineOf(const Solution& solution, const Covariance& clustered) {
  const Budget budget = BudgetOf(solution.problem, solution.fit.estimate, solution.linear);
  const Eigen::Index n = clustered.matrix.rows();
  Headline headline = solution.variances ? Weighted(solution.problem, *solution.variances, budget, n)
                                         : Clustered(solution.problem, clustered, budget, n);
  headline.covariance = (headline.covariance + headline.covariance.transpose().eval()) / 2;
  if (solution.variances) AddScatterOfViews(solution, clustered, &headline);
  AddShares(&headline);
  return headline;
}

double PureError::sigma() const { return dof > 0 ? std::sqrt(sum_of_squares / dof) : 0; }

std::vector<Eigen::VectorXd> ResidualsOf(const Solution& solution, size_t target) {
  const std::vector<double> values = Values(solution.problem, solution.fit.estimate, target);
  std::vector<Eigen::VectorXd> residuals;
  for (const Block& view : solution.problem.targets[target].views)
    if (view.prior.empty())
      Block{view.rows, 1, {}, {}, {}}.Evaluate(values.data(), {}, &residuals.emplace_back(), nullptr);
  return residuals;
}

Solution Solve(Problem problem, const Estimate& start, const RefineOptions& options) {
  Solution solution{std::move(problem), {}, {}, {}, {}, {}};
  solution.fit = Refine(solution.problem, start, options);
  solution.linear = Linearize(solution.problem, solution.fit.estimate, Storey::kViews);
  solution.observability = Observe(solution.problem, solution.linear);
  solution.naive = NaiveCovariance(solution.problem, solution.linear);
  return solution;
}

Solution SolveWeighted(const Solution& plain, double least, const RefineOptions& options) {
  Problem problem = plain.problem;
  Estimate start = plain.fit.estimate;
  Variances variances = EstimateVariances(&problem, &start, least);
  const bool ordered =
      std::any_of(problem.quantities.begin(), problem.quantities.end(), [](const Quantity& q) { return q.in_order; });
  Solution solution = Solve(std::move(problem), start, options);
  if (ordered) {
    const Neighbours neighbours = CorrelationOfNeighbours(solution.problem, solution.fit.estimate, solution.linear);
    NeighboursFound found;
    if (neighbours.IsSuspected()) found = EstimateNeighbours(&solution.problem, solution.fit.estimate, &variances);
    if (found.what == NeighboursFound::kNoise)
      solution = Solve(std::move(solution.problem), solution.fit.estimate, options);
    solution.neighbours = found;
  }
  solution.fit.iterations += plain.fit.iterations;
  solution.naive = plain.naive;
  solution.variances = std::move(variances);
  return solution;
}

Calibration Summarize(const Solution& solution, const PureError& pure_error) {
  const Covariance clustered = ClusteredCovariance(solution.problem, solution.linear);
  const Jackknife jackknife = LeaveOneTargetOut(solution.problem, solution.fit, solution.linear);
  const Headline headline = HeadlineOf(solution, clustered);

  Calibration result;
  result.covariance = headline.covariance;
  result.budget = headline.budget;
  result.iterations = solution.fit.iterations;
  result.converged = solution.fit.converged;
  result.condition = solution.observability.condition;
  AddParameters(solution, headline, clustered, jackknife, &result);
  AddTargets(solution, pure_error, &result);
  AddInfluences(solution, &result);
  result.warnings = headline.warnings;
  if (!solution.variances) result.budget.front().u = result.sigma;
  // Views of many rows tell the variances better than their mere number.
  const double noise_dof = solution.variances && headline.dof.size() > 0
                               ? std::max(clustered.dof, std::min(headline.dof.minCoeff(), kKnown_dof))
                               : clustered.dof;
  if (solution.variances) result.noise_dof = noise_dof;
  if (solution.variances) {
    const Neighbours neighbours = CorrelationOfNeighbours(solution.problem, solution.fit.estimate, solution.linear);
    result.neighbours = neighbours.correlation;
    for (const Quantity& quantity : solution.problem.quantities)
      result.neighbour_noise = std::max(result.neighbour_noise, quantity.neighbour);
    result.misfits = TestMisfits(solution.problem, solution.fit.estimate, solution.linear, noise_dof);
  }
  for (Eigen::Index t = 0; t < jackknife.estimates.rows(); ++t)
    result.jackknife.push_back(Plain(jackknife.estimates.row(t).transpose()));
  AddDoubts(solution, jackknife, noise_dof, &result);
  return result;
}

}  // namespace scancal
