#include "solver/uncertainty/variances.h"
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include "solver/linearize.h"
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

// The unit effects of every unknown source on one view's rows, side by side; they hardly change with the estimate.
struct ViewEffects {
  std::vector<Eigen::MatrixXd> of_source;  // rows x instances, for u = 1
  std::vector<bool> of_points;             // acts on single points
};

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

// X' V_k X for an orthonormal basis X of the whitened Jacobian: of one target's own part, of the system's, and across.
struct Projected {
  std::vector<Eigen::MatrixXd> own, across;  // per target
  Eigen::MatrixXd system;
  double TraceOfProduct(const Projected& other) const {
    double trace = system.cwiseProduct(other.system).sum();
    for (size_t t = 0; t < own.size(); ++t)
      trace += own[t].cwiseProduct(other.own[t]).sum() + 2 * across[t].cwiseProduct(other.across[t]).sum();
    return trace;
  }
};

// Score and expected information of the unknown variances.
class Likelihood {
 public:
  Likelihood(Eigen::Index sources, size_t targets, Eigen::Index own, Eigen::Index system)
      : score(Eigen::VectorXd::Zero(sources)),
        information(Eigen::MatrixXd::Zero(sources, sources)),
        average(Eigen::MatrixXd::Zero(sources, sources)),
        own_pull_(targets, Eigen::MatrixXd::Zero(own, sources)),
        system_pull_(Eigen::MatrixXd::Zero(system, sources)),
        projected_(sources, {std::vector<Eigen::MatrixXd>(targets, Eigen::MatrixXd::Zero(own, own)),
                             std::vector<Eigen::MatrixXd>(targets, Eigen::MatrixXd::Zero(own, system)),
                             Eigen::MatrixXd::Zero(system, system)}) {}

  // r: whitened and free of X; point_variance: what one row of the view has from all its point noise.
  void Add(size_t target, const Block& view, const ViewEffects& effects, const Eigen::VectorXd& r,
           const Eigen::MatrixXd& own, const Eigen::MatrixXd& system, double point_variance) {
    const auto n = score.size();
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
      score[k] += 0.5 * (on_r.squaredNorm() - f[k].squaredNorm() - more * row[k]);
      projected_[k].own[target] += of_own[k].transpose() * of_own[k];
      projected_[k].across[target] += of_own[k].transpose() * of_system[k];
      projected_[k].system += of_system[k].transpose() * of_system[k];
    }
    own_pull_[target] += own.transpose() * pulled;
    system_pull_ += system.transpose() * pulled;
    average += 0.5 * pulled.transpose() * pulled;
    for (Eigen::Index k = 0; k < n; ++k) {
      for (Eigen::Index l = 0; l <= k; ++l) {
        const Eigen::MatrixXd between = f[k].transpose() * f[l];
        const double through = (of_own[k].transpose() * between).cwiseProduct(of_own[l].transpose()).sum() +
                               (of_system[k].transpose() * between).cwiseProduct(of_system[l].transpose()).sum();
        information(k, l) += 0.5 * (between.squaredNorm() - 2 * through + more * row[k] * row[l]);
      }
    }
  }

  void Finish() {
    average -= 0.5 * system_pull_.transpose() * system_pull_;
    for (const Eigen::MatrixXd& pull : own_pull_) average -= 0.5 * pull.transpose() * pull;
    for (Eigen::Index k = 0; k < score.size(); ++k) {
      double trace = projected_[k].system.trace();
      for (const Eigen::MatrixXd& own : projected_[k].own) trace += own.trace();
      score[k] += 0.5 * trace;
      for (Eigen::Index l = 0; l <= k; ++l) {
        information(k, l) += 0.5 * projected_[k].TraceOfProduct(projected_[l]);
        information(l, k) = information(k, l);
      }
    }
  }

  Eigen::VectorXd score;
  Eigen::MatrixXd information;  // expected
  Eigen::MatrixXd average;      // of expected and observed: r'P V_k P V_l P r / 2 (Gilmour, Thompson and Cullis 1995)

  // For the last steps: the observed information where it is positive definite, else the average.
  Eigen::MatrixXd Curvature() const {
    const Eigen::MatrixXd observed = 2 * average - information;
    const bool positive = Eigen::LLT<Eigen::MatrixXd>(observed).info() == Eigen::Success;
    return positive ? observed : average;
  }

 private:
  std::vector<Eigen::MatrixXd> own_pull_;  // X' V_k P r
  Eigen::MatrixXd system_pull_;
  std::vector<Projected> projected_;
};

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
double Step(const Likelihood& likelihood, const Eigen::MatrixXd& information, const Eigen::VectorXd& least,
            Eigen::VectorXd* variance) {
  const auto n = variance->size();
  const Eigen::VectorXd error = likelihood.information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd lowest = (*variance / kLargestStep).cwiseMax(least) - *variance,
                        highest = *variance * (kLargestStep - 1);
  std::vector<Eigen::Index> free;
  for (Eigen::Index k = 0; k < n; ++k)
    if (likelihood.score[k] > 0 || (*variance)[k] > kAtZero * error[k]) free.push_back(k);
  Eigen::VectorXd move = Eigen::VectorXd::Zero(n);
  for (bool bounded = true; bounded && !free.empty();) {
    const Eigen::VectorXd score = likelihood.score - information * move;  // where the bounded ones have gone
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
      const Likelihood likelihood = Evaluate();
      result.covariance = Inverse(likelihood.information);
      result.converged = Step(likelihood, step < kFisherSteps ? likelihood.information : likelihood.Curvature(), lowest,
                              &result.variance) < kSettled;
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
  Likelihood Evaluate() {
    const Linearization linear = Linearize(problem_, at_, Storey::kViews);
    const auto n = linear.factor.cols();
    const Eigen::MatrixXd to_basis =
        linear.factor.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(n, n));
    const Estimate step = GaussNewtonStep(linear);
    const std::vector<int> noise = problem_.With({Scope::kPoint}, Role::kConsider);
    Likelihood likelihood(unknown_.size(), problem_.targets.size(), linear.targets[0].q.cols(), n);
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

}  // namespace

double Variances::Dof(const std::string& source) const {
  const auto found = std::find(sources.begin(), sources.end(), source);
  if (found == sources.end()) return std::numeric_limits<double>::infinity();
  const auto k = found - sources.begin();
  return 2 * variance[k] * variance[k] / covariance(k, k);
}

double Variances::Dof(const Eigen::VectorXd& share, double total) const {
  if (sources.empty()) return std::numeric_limits<double>::infinity();
  const Eigen::VectorXd gradient = (variance.array() > 0).select(share.array() / variance.array(), 0.0);
  return 2 * total * total / gradient.dot(covariance * gradient);
}

Variances EstimateVariances(Problem* problem, Estimate* at, double least) {
  std::vector<int> declared;
  for (const int k : problem->With({Scope::kView, Scope::kPoint}, Role::kConsider))
    if (problem->quantities[k].u > 0) declared.push_back(k);
  if (declared.empty()) return Estimation(problem, at, least).Run();

  // What would the data say of the declared ones?
  Problem free = *problem;
  Estimate there = *at;
  for (const int k : declared) free.quantities[k].role = Role::kEstimate;
  const Variances told = Estimation(&free, &there, least).Run();
  std::vector<Exceeded> exceeded;
  for (const int k : declared) {
    Quantity& quantity = problem->quantities[k];
    const auto i = std::find(told.sources.begin(), told.sources.end(), quantity.Source()) - told.sources.begin();
    const double error = std::sqrt(told.covariance(i, i)), more = told.variance[i] - quantity.u * quantity.u;
    if (!(more > kMoreThanDeclared * error)) continue;
    quantity.role = Role::kEstimate;
    if (exceeded.empty() || exceeded.back().source != quantity.Source())
      exceeded.push_back({quantity.Source(), quantity.u, 0});
  }
  Variances result = Estimation(problem, at, least).Run();
  for (Exceeded& each : exceeded) {
    const auto i = std::find(result.sources.begin(), result.sources.end(), each.source) - result.sources.begin();
    each.estimated = std::sqrt(result.variance[i]);
  }
  result.exceeded = std::move(exceeded);
  return result;
}

}  // namespace scancal
