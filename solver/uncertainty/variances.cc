#include "solver/uncertainty/variances.h"
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include "solver/affine.h"
#include "solver/linearize.h"
#include "solver/uncertainty/restricted_likelihood.h"
#include "solver/weigh.h"

namespace scancal {
namespace {

constexpr int kMostSteps = 60;
constexpr int kFisherSteps = 5;          // sure, but slow where the model is not quite right
constexpr double kSettled = 1e-3;        // of a standard error
constexpr double kLowest = 1e-10;        // of the variance at the start
constexpr double kLargestStep = 25;      // a variance changes by no more than this factor, and its inverse
constexpr double kAtZero = 1e-4;         // of a standard error: a variance below this and falling is zero
constexpr double kConfounded = 1e-8;     // of the largest eigenvalue of the scaled information
constexpr double kMoreThanDeclared = 3;  // standard errors
constexpr double kMatters = 0.1;         // of a variance: 5 % of u

struct Sources {
  std::vector<std::string> names;
  std::vector<int> quantities;       // all unknown ones
  std::vector<Eigen::Index> source;  // of each of them
  Eigen::Index size() const { return std::ssize(names); }
};

Sources UnknownSources(const Problem& problem) {
  Sources unknown;
  for (const int k : problem.With({Scope::kView, Scope::kPoint}, Role::kEstimate)) {
    const std::string& name = problem.quantities[k].Source();
    auto found = std::find(unknown.names.begin(), unknown.names.end(), name);
    if (found == unknown.names.end()) found = unknown.names.insert(found, name);
    unknown.quantities.push_back(k);
    unknown.source.push_back(found - unknown.names.begin());
  }
  return unknown;
}

void SetVariances(const Sources& unknown, const Eigen::VectorXd& variance, Problem* problem) {
  for (size_t k = 0; k < unknown.quantities.size(); ++k)
    problem->quantities[unknown.quantities[k]].u = std::sqrt(variance[unknown.source[k]]);
}

ViewEffects EffectsOn(const Block& view, const Problem& problem, const Sources& unknown,
                      const std::vector<double>& values) {
  ViewEffects effects{std::vector<Eigen::MatrixXd>(unknown.names.size()), std::vector<bool>(unknown.names.size())};
  const Eigen::MatrixXd derivatives = RawDerivatives(view, values, unknown.quantities);
  for (Eigen::Index k = 0; k < derivatives.cols(); ++k) {
    const Scope scope = problem.quantities[unknown.quantities[k]].scope;
    const Eigen::MatrixXd instances = Instances(derivatives.col(k), view.rows->points(), scope);
    Eigen::MatrixXd& all = effects.of_source[unknown.source[k]];
    const Eigen::Index before = all.cols();
    all.conservativeResize(instances.rows(), before + instances.cols());
    all.rightCols(instances.cols()) = instances;
    if (scope == Scope::kPoint) effects.of_points[unknown.source[k]] = true;
  }
  return effects;
}

// Pseudo-inverse in units of the standard errors: what the data cannot tell apart stays as it is.
Eigen::MatrixXd Inverse(const Eigen::MatrixXd& information) {
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * information * scale.asDiagonal());
  const Eigen::ArrayXd values = eigen.eigenvalues().array();
  const Eigen::ArrayXd inverse = (values > kConfounded * values.maxCoeff()).select(values.inverse(), 0.0);
  return scale.asDiagonal() * eigen.eigenvectors() * inverse.matrix().asDiagonal() * eigen.eigenvectors().transpose() *
         scale.asDiagonal();
}

// One step to the maximum of score'm - m'(information)m / 2, the variances kept positive: those that would fall or rise
// too far go as far as they may, the others make the best of it; those at zero stay there. Returns the largest move in
// standard errors.
double Step(const RestrictedLikelihood& likelihood, const Eigen::MatrixXd& information, const Eigen::VectorXd& least,
            Eigen::VectorXd* variance) {
  const auto n = variance->size();
  const Eigen::VectorXd error = likelihood.information().diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd lowest = (*variance / kLargestStep).cwiseMax(least) - *variance,
                        highest = *variance * (kLargestStep - 1);
  std::vector<Eigen::Index> free;
  for (Eigen::Index k = 0; k < n; ++k)
    if (likelihood.score()[k] > 0 || (*variance)[k] > kAtZero * error[k]) free.push_back(k);
  Eigen::VectorXd move = Eigen::VectorXd::Zero(n);
  for (bool bounded = true; bounded && !free.empty();) {
    const Eigen::VectorXd score = likelihood.score() - information * move;  // where the bounded ones have gone
    const Eigen::VectorXd best = Inverse(information(free, free)) * score(free);
    bounded = false;
    std::vector<Eigen::Index> left;
    for (size_t i = 0; i < free.size(); ++i) {
      const Eigen::Index k = free[i];
      const double m = best[static_cast<Eigen::Index>(i)];
      if (m >= lowest[k] && m <= highest[k]) {
        left.push_back(k);
        continue;
      }
      move[k] = std::clamp(m, lowest[k], highest[k]);
      bounded = true;
    }
    if (!bounded) move(free) = best;
    free = std::move(left);
  }
  *variance += move;
  return move.cwiseAbs().cwiseQuotient(error).maxCoeff();
}

class Estimation {
 public:
  Estimation(Problem* problem, Estimate* at, double least) : problem_(*problem), at_(*at), least_(least) {
    unknown_ = UnknownSources(problem_);
    for (size_t t = 0; t < problem_.targets.size(); ++t) {
      const std::vector<double> values = Values(problem_, at_, t);
      for (const Block& view : problem_.targets[t].views)
        if (view.prior.empty()) effects_.push_back(EffectsOn(view, problem_, unknown_, values));
    }
    for (const int k : unknown_.quantities) problem_.quantities[k].role = Role::kConsider;
  }

  Variances Run() {
    Variances result;
    result.sources = unknown_.names;
    result.variance = Start();  // sets least_variance_ as well
    result.covariance = Eigen::MatrixXd::Zero(unknown_.size(), unknown_.size());
    SetVariances(unknown_, result.variance, &problem_);
    Weigh(&problem_, at_);
    result.converged = unknown_.size() == 0;
    const Eigen::VectorXd lowest = (kLowest * result.variance).cwiseMax(least_variance_);
    for (int step = 0; step < kMostSteps && !result.converged; ++step) {
      const RestrictedLikelihood likelihood = Evaluate();
      result.covariance = Inverse(likelihood.information());
      result.converged = Step(likelihood, step < kFisherSteps ? likelihood.information() : likelihood.Curvature(),
                              lowest, &result.variance) < kSettled;
      SetVariances(unknown_, result.variance, &problem_);
      Weigh(&problem_, at_);
    }
    return result;
  }

 private:
  // Every unknown source as large as the whole residual: a row's mean square where it acts at all. A declared one
  // stands where it was declared.
  Eigen::VectorXd Start() {
    double squares = 0, count = 0, rows = 0;
    Eigen::VectorXd effect = Eigen::VectorXd::Zero(unknown_.size());
    size_t v = 0;
    for (size_t t = 0; t < problem_.targets.size(); ++t) {
      const std::vector<double> values = Values(problem_, at_, t);
      for (const Block& view : problem_.targets[t].views) {
        if (!view.prior.empty()) continue;
        Eigen::VectorXd r;
        Block{view.rows, 1, {}, {}, {}}.Evaluate(values.data(), {}, &r, nullptr);
        squares += r.squaredNorm();
        count += view.rows->count();
        rows += static_cast<double>(r.size());
        for (Eigen::Index k = 0; k < effect.size(); ++k) effect[k] += effects_[v].of_source[k].squaredNorm();
        ++v;
      }
    }
    const double mean_square = std::max(squares / std::max(1.0, count), least_ * least_);
    Eigen::VectorXd start(unknown_.size());
    least_variance_ = Eigen::VectorXd::Zero(unknown_.size());
    for (size_t k = 0; k < unknown_.quantities.size(); ++k)
      if (problem_.quantities[unknown_.quantities[k]].scope == Scope::kPoint && effect[unknown_.source[k]] > 0)
        least_variance_[unknown_.source[k]] = least_ * least_ * rows / effect[unknown_.source[k]];
    for (Eigen::Index k = 0; k < start.size(); ++k) start[k] = effect[k] > 0 ? mean_square * rows / effect[k] : 0;
    for (size_t k = 0; k < unknown_.quantities.size(); ++k)
      if (const double u = problem_.quantities[unknown_.quantities[k]].u; u > 0) start[unknown_.source[k]] = u * u;
    return start;
  }

  // At the present variances; moves the estimate to their minimum.
  RestrictedLikelihood Evaluate() {
    const Linearization linear = Linearize(problem_, at_, Storey::kViews);
    const auto n = linear.factor.cols();
    const Eigen::MatrixXd to_basis =
        linear.factor.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(n, n));
    const Estimate step = GaussNewtonStep(linear);
    const std::vector<int> noise = problem_.With({Scope::kPoint}, Role::kConsider);
    RestrictedLikelihood likelihood(unknown_.size(), problem_.targets.size(), linear.targets[0].q.cols(), n);
    size_t v = 0;
    for (size_t t = 0; t < problem_.targets.size(); ++t) {
      const LinearTarget& target = linear.targets[t];
      const Eigen::VectorXd left =
          target.r - target.q * (target.q.transpose() * target.r) + target.system_left * step.system;
      const std::vector<double> values = Values(problem_, at_, t);
      for (size_t b = 0; b < problem_.targets[t].views.size(); ++b) {
        const Block& view = problem_.targets[t].views[b];
        if (!view.prior.empty()) continue;
        const auto rows = target.first[b + 1] - target.first[b];
        double point_variance = 0;  // of one row
        const Eigen::MatrixXd by_noise = RawDerivatives(view, values, noise);
        for (Eigen::Index k = 0; k < by_noise.cols(); ++k)
          point_variance +=
              by_noise.col(k).squaredNorm() / static_cast<double>(rows) * std::pow(problem_.quantities[noise[k]].u, 2);
        likelihood.Add(t, view, effects_[v++], left.segment(target.first[b], rows),
                       target.q.middleRows(target.first[b], rows),
                       target.system_left.middleRows(target.first[b], rows) * to_basis, point_variance);
      }
      at_.targets[t] += step.targets[t];
    }
    at_.system += step.system;
    likelihood.Finish();
    return likelihood;
  }

  Problem& problem_;
  Estimate& at_;
  double least_;
  Sources unknown_;
  Eigen::VectorXd least_variance_;    // of point noise: every row needs some
  std::vector<ViewEffects> effects_;  // per view that is no prior
};

// On the affine problem, in which what is considered is estimated with its u as prior: or it would count as noise.
Variances EstimateUnknown(Problem* problem, Estimate* at, double least) {
  Problem free = *problem;
  const std::vector<int> considered = problem->With({Scope::kSystem, Scope::kTarget}, Role::kConsider);
  for (const int k : considered) free.quantities[k].role = Role::kEstimate;
  free.AddPriors(considered);
  Estimate there = NominalStart(free);
  for (size_t t = 0; t < problem->targets.size(); ++t) SetValues(free, Values(*problem, *at, t), t, &there);
  Problem affine = Affine(free, there);
  Variances result = Estimation(&affine, &there, least).Run();
  for (const int k : problem->With({Scope::kView, Scope::kPoint}, Role::kEstimate))
    problem->quantities[k] = affine.quantities[k];
  return result;
}

Eigen::Index IndexOf(const std::string& source, const std::vector<std::string>& sources) {
  return std::find(sources.begin(), sources.end(), source) - sources.begin();
}

// Of what is declared, those sources of which the data show significantly more: they become unknown, from where they
// were declared.
std::vector<std::string> ReleaseExceeded(Problem* problem, Estimate at, double least) {
  Problem free = *problem;
  std::vector<int> declared;
  for (const int k : problem->With({Scope::kView, Scope::kPoint}, Role::kConsider)) {
    declared.push_back(k);
    free.quantities[k].role = Role::kEstimate;
  }
  std::vector<std::string> larger;
  if (declared.empty()) return larger;
  const Variances told = EstimateUnknown(&free, &at, least);
  for (const int k : declared) {
    Quantity& quantity = problem->quantities[k];
    const Eigen::Index i = IndexOf(quantity.Source(), told.sources);
    const double declared_variance = quantity.u * quantity.u;
    const double clearly = std::max(kMoreThanDeclared * std::sqrt(told.covariance(i, i)), kMatters * declared_variance);
    if (!(told.variance[i] - declared_variance > clearly)) continue;
    quantity.role = Role::kEstimate;
    if (larger.empty() || larger.back() != quantity.Source()) larger.push_back(quantity.Source());
  }
  return larger;
}

}  // namespace

double Variances::Dof(const std::string& source) const {
  const Eigen::Index k = IndexOf(source, sources);
  if (k == std::ssize(sources)) return std::numeric_limits<double>::infinity();
  return 2 * variance[k] * variance[k] / covariance(k, k);
}

double Variances::Dof(const Eigen::VectorXd& share, double total) const {
  if (sources.empty()) return std::numeric_limits<double>::infinity();
  const Eigen::VectorXd gradient = (variance.array() > 0).select(share.array() / variance.array(), 0.0);
  return 2 * total * total / gradient.dot(covariance * gradient);
}

Variances EstimateVariances(Problem* problem, Estimate* at, double least) {
  const std::vector<std::string> larger = ReleaseExceeded(problem, *at, least);
  std::vector<Exceeded> exceeded;
  for (const std::string& source : larger)
    for (const Quantity& quantity : problem->quantities)
      if (quantity.Source() == source && (exceeded.empty() || exceeded.back().source != source))
        exceeded.push_back({source, quantity.u, 0});
  Variances result = EstimateUnknown(problem, at, least);
  for (Exceeded& each : exceeded) each.estimated = std::sqrt(result.variance[IndexOf(each.source, result.sources)]);
  result.exceeded = std::move(exceeded);
  Weigh(problem, *at);
  return result;
}

}  // namespace scancal
