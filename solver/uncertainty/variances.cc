#include "solver/uncertainty/variances.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include "solver/dense.h"
#include "solver/linearize.h"
#include "solver/uncertainty/gum.h"
#include "solver/weigh.h"

namespace scancal {
namespace {

constexpr int kMostSteps = 60;
constexpr int kFisherSteps = 5;          // sure, but slow where the model is not quite right
constexpr double kSettledStep = 1e-3;    // of a standard error
constexpr double kLowest = 1e-10;        // of the variance at the start
constexpr double kLargestStep = 25;      // a variance changes by no more than this factor, and its inverse
constexpr double kAtZero = 1e-4;         // of a standard error: a variance below this and falling is zero
constexpr double kConfounded = 1e-8;     // of the largest eigenvalue of the scaled information
constexpr double kMoreThanDeclared = 3;  // standard errors
constexpr double kKnown_dof = 1e9;       // as good as infinitely many
constexpr double kMatters = 0.1;         // of a variance: 5 % of u

// The unit effects of every unknown source on one view's rows, side by side; they hardly change with the estimate.
struct ViewEffects {
  std::vector<Eigen::MatrixXd> of_source;  // rows x instances, for u = 1
  std::vector<bool> of_points;             // acts on single points
};

// With P = V^-1 - V^-1 J (J'V^-1 J)^-1 J'V^-1 and V_k the covariance of source k for u = 1 (Patterson and Thompson
// 1971; Searle, Casella and McCulloch, Variance Components, 6.6). Time and memory are linear in the views.
class RestrictedLikelihood {
 public:
  // own, system: numbers of estimated quantities of one target, of the system.
  RestrictedLikelihood(Eigen::Index sources, size_t targets, Eigen::Index own, Eigen::Index system);
  // One view, whitened: residuals r (free of what the estimate explains) and its rows of an orthonormal basis of the
  // Jacobian, the target's own part and the system's. point_variance: what one row has from all its point noise.
  void Add(size_t target, const Block& view, const ViewEffects& effects, const Eigen::VectorXd& r,
           const Eigen::MatrixXd& own, const Eigen::MatrixXd& system, double point_variance);
  void Finish();  // after the last view

  const Eigen::VectorXd& score() const { return score_; }              // (r'P V_k P r - tr P V_k) / 2
  const Eigen::MatrixXd& information() const { return information_; }  // expected: tr(P V_k P V_l) / 2
  // For the last steps: the observed information where it is positive definite, else its average with the expected one
  // (Gilmour, Thompson and Cullis 1995).
  Eigen::MatrixXd Curvature() const;

 private:
  struct Projected {  // X' V_k X: of each target's own part of the basis, of the system's, and across
    std::vector<Eigen::MatrixXd> own, across;
    Eigen::MatrixXd system;
    double TraceOfProduct(const Projected& other) const;
  };

  Eigen::VectorXd score_;
  Eigen::MatrixXd information_, average_;  // average_: r'P V_k P V_l P r / 2
  std::vector<Eigen::MatrixXd> own_pull_;  // X' V_k P r
  Eigen::MatrixXd system_pull_;
  std::vector<Projected> projected_;
};

RestrictedLikelihood::RestrictedLikelihood(Eigen::Index sources, size_t targets, Eigen::Index own, Eigen::Index system)
    : score_(Eigen::VectorXd::Zero(sources)),
      information_(Eigen::MatrixXd::Zero(sources, sources)),
      average_(Eigen::MatrixXd::Zero(sources, sources)),
      own_pull_(targets, Eigen::MatrixXd::Zero(own, sources)),
      system_pull_(Eigen::MatrixXd::Zero(system, sources)),
      projected_(sources, {std::vector<Eigen::MatrixXd>(targets, Eigen::MatrixXd::Zero(own, own)),
                           std::vector<Eigen::MatrixXd>(targets, Eigen::MatrixXd::Zero(own, system)),
                           Eigen::MatrixXd::Zero(system, system)}) {}

double RestrictedLikelihood::Projected::TraceOfProduct(const Projected& other) const {
  double trace = system.cwiseProduct(other.system).sum();
  for (size_t t = 0; t < own.size(); ++t)
    trace += own[t].cwiseProduct(other.own[t]).sum() + 2 * across[t].cwiseProduct(other.across[t]).sum();
  return trace;
}

void RestrictedLikelihood::Add(size_t target, const Block& view, const ViewEffects& effects, const Eigen::VectorXd& r,
                               const Eigen::MatrixXd& own, const Eigen::MatrixXd& system, double point_variance) {
  const auto n = score_.size();
  const double more = view.rows->count() - static_cast<double>(r.size());
  std::vector<Eigen::MatrixXd> f(n), of_own(n), of_system(n);
  Eigen::VectorXd row = Eigen::VectorXd::Zero(n);  // of the point noise per row
  Eigen::MatrixXd pulled(r.size(), n);             // V_k P r, whitened
  for (Eigen::Index k = 0; k < n; ++k) {
    f[k] = view.Weighted(effects.of_source[k]);
    of_own[k] = f[k].transpose() * own;
    of_system[k] = f[k].transpose() * system;
    if (effects.of_points[k])
      row[k] = effects.of_source[k].squaredNorm() / static_cast<double>(r.size()) / point_variance;
    const Eigen::VectorXd on_r = f[k].transpose() * r;
    pulled.col(k) = f[k] * on_r;
    score_[k] += 0.5 * (on_r.squaredNorm() - f[k].squaredNorm() - more * row[k]);
    projected_[k].own[target] += of_own[k].transpose() * of_own[k];
    projected_[k].across[target] += of_own[k].transpose() * of_system[k];
    projected_[k].system += of_system[k].transpose() * of_system[k];
  }
  own_pull_[target] += own.transpose() * pulled;
  system_pull_ += system.transpose() * pulled;
  average_ += 0.5 * pulled.transpose() * pulled;
  for (Eigen::Index k = 0; k < n; ++k) {
    for (Eigen::Index l = 0; l <= k; ++l) {
      const Eigen::MatrixXd between = f[k].transpose() * f[l];
      const double through = (of_own[k].transpose() * between).cwiseProduct(of_own[l].transpose()).sum() +
                             (of_system[k].transpose() * between).cwiseProduct(of_system[l].transpose()).sum();
      information_(k, l) += 0.5 * (between.squaredNorm() - 2 * through + more * row[k] * row[l]);
    }
  }
}

void RestrictedLikelihood::Finish() {
  average_ -= 0.5 * system_pull_.transpose() * system_pull_;
  for (const Eigen::MatrixXd& pull : own_pull_) average_ -= 0.5 * pull.transpose() * pull;
  for (Eigen::Index k = 0; k < score_.size(); ++k) {
    double trace = projected_[k].system.trace();
    for (const Eigen::MatrixXd& own : projected_[k].own) trace += own.trace();
    score_[k] += 0.5 * trace;
    for (Eigen::Index l = 0; l <= k; ++l) {
      information_(k, l) += 0.5 * projected_[k].TraceOfProduct(projected_[l]);
      information_(l, k) = information_(k, l);
    }
  }
}

Eigen::MatrixXd RestrictedLikelihood::Curvature() const {
  const Eigen::MatrixXd observed = 2 * average_ - information_;
  return Cholesky(observed).ok() ? observed : average_;
}

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
  const SymmetricEigen eigen = EigenOf(scale.asDiagonal() * information * scale.asDiagonal());
  const Eigen::ArrayXd values = eigen.values.array();
  const Eigen::ArrayXd inverse = (values > kConfounded * values.maxCoeff()).select(values.inverse(), 0.0);
  return scale.asDiagonal() * eigen.vectors * inverse.matrix().asDiagonal() * eigen.vectors.transpose() *
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
                              lowest, &result.variance) < kSettledStep;
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
  for (Exceeded& each : exceeded) {
    each.estimated = std::sqrt(result.variance[IndexOf(each.source, result.sources)]);
    each.p =
        FUpperTail(std::pow(each.estimated / each.declared, 2), std::max(1.0, result.Dof(each.source)), kKnown_dof);
  }
  result.exceeded = std::move(exceeded);
  Weigh(problem, *at);
  return result;
}

}  // namespace scancal
