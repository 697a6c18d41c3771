#include "solver/uncertainty/neighbours.h"
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include "solver/dense.h"
#include "solver/parallel.h"
#include "solver/weigh.h"

namespace scancal {
namespace {

constexpr int kMostRows = 12;
constexpr double kFewestStretches = 5;
constexpr double kSignificant = 16, kLeastCorrelation = 0.1;
constexpr int kMostEvaluations = 240;
constexpr std::string_view kPrior = "prior of ";  // as Problem::AddPriors names them
constexpr double kSmall = 1e-6;                   // mm, rad: where a standard deviation begins that may be none
constexpr double kSettled = 1e-2;                 // of -2 l: a tenth of a standard error

using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostRows, kMostRows>;

struct View {
  Eigen::MatrixXd columns;  // own, system, r; divided by the noise of points
  Small effects;            // of the ordered quantities, the same
};

struct Ordered {  // one target
  std::vector<View> views;
  Eigen::MatrixXd priors;          // rows as columns of a view; of its own quantities
  std::vector<Eigen::Index> free;  // of each prior: which of the sources whose u is free, or -1
};

// What the likelihood is a function of.
struct Guess {
  Eigen::VectorXd of_view;    // u of each quantity of view scope
  Eigen::VectorXd of_target;  // of each source that is held
  double rho = 0;
};

// -2 l of the variances and the correlation.
class Likelihood {
 public:
  // free: priors of target scope that stand in the problem with u = 1.
  Likelihood(const Problem& problem, const Estimate& at, const std::vector<std::string>& free) {
    const std::vector<int> own = problem.With({Scope::kTarget}, Role::kEstimate),
                           system = problem.With({Scope::kSystem}, Role::kEstimate),
                           points = problem.With({Scope::kPoint}, Role::kConsider);
    for (const int k : problem.With({Scope::kView}, Role::kConsider)) quantities_.push_back(k);
    own_ = std::ssize(own);
    system_ = std::ssize(system);
    std::vector<int> seeds = own;
    seeds.insert(seeds.end(), system.begin(), system.end());
    for (size_t t = 0; t < problem.targets.size(); ++t) {
      const std::vector<double> values = Values(problem, at, t);
      Ordered& target = targets_.emplace_back();
      target.priors.resize(0, own_ + system_ + 1);
      for (const Block& block : problem.targets[t].views) {
        Eigen::VectorXd r;
        Eigen::MatrixXd jacobian;
        if (!block.prior.empty()) {
          block.Evaluate(values.data(), seeds, &r, &jacobian);
          target.priors.conservativeResize(target.priors.rows() + r.size(), Eigen::NoChange);
          target.priors.bottomRows(r.size()) << jacobian, r;
          const auto found = std::find(free.begin(), free.end(), block.prior);
          target.free.resize(static_cast<size_t>(target.priors.rows()),
                             found == free.end() ? -1 : found - free.begin());
          continue;
        }
        if (block.rows->size() > kMostRows || std::ssize(quantities_) > kMostRows) {
          sound_ = false;
          return;
        }
        Block{block.rows, 1, {}, {}, {}}.Evaluate(values.data(), seeds, &r, &jacobian);
        const Eigen::MatrixXd by_point = RawDerivatives(block, values, points);
        Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(r.size(), r.size());
        for (Eigen::Index k = 0; k < by_point.cols(); ++k) {
          const Eigen::MatrixXd b =
              Instances(by_point.col(k) * problem.quantities[points[k]].u, block.rows->points(), Scope::kPoint);
          covariance += b * b.transpose();
        }
        const Eigen::MatrixXd whitening = Whitening(covariance);
        View& view = target.views.emplace_back();
        view.columns.resize(r.size(), jacobian.cols() + 1);
        view.columns << whitening * jacobian, whitening * r;
        view.effects = whitening * RawDerivatives(block, values, quantities_);
      }
    }
    system_priors_.resize(0, system_ + 1);
    for (const Block& prior : problem.priors) {
      Eigen::VectorXd r;
      Eigen::MatrixXd jacobian;
      prior.Evaluate(Values(problem, at, 0).data(), system, &r, &jacobian);
      system_priors_.conservativeResize(system_priors_.rows() + r.size(), Eigen::NoChange);
      system_priors_.bottomRows(r.size()) << jacobian, r;
    }
  }

  bool sound() const { return sound_ && !quantities_.empty(); }
  const std::vector<int>& quantities() const { return quantities_; }
  double views() const {
    double sum = 0;
    for (const Ordered& target : targets_) sum += static_cast<double>(target.views.size());
    return sum;
  }

  double At(const Guess& guess) const {
    double logs = 0;
    TriangularFactor whole(static_cast<int>(system_) + 1);
    whole.Add(system_priors_);
    std::vector<Eigen::MatrixXd> triangles(targets_.size());
    std::vector<double> of_target(targets_.size());
    InParallel(targets_.size(), 0,
               [&](size_t t) { triangles[t] = UpperTriangle(Filtered(targets_[t], guess, &of_target[t])); });
    for (size_t t = 0; t < targets_.size(); ++t) {
      const Eigen::MatrixXd& r = triangles[t];
      logs += of_target[t];
      for (Eigen::Index k = 0; k < own_; ++k) logs += 2 * std::log(std::abs(r(k, k)));
      whole.Add(r.bottomRightCorner(system_ + 1, system_ + 1));
    }
    const Eigen::MatrixXd r = whole.R();
    for (Eigen::Index k = 0; k < system_; ++k) logs += 2 * std::log(std::abs(r(k, k)));
    return logs + r(system_, system_) * r(system_, system_);
  }

 private:
  // The innovations of all columns, divided by their standard deviations.
  Eigen::MatrixXd Filtered(const Ordered& target, const Guess& guess, double* logs) const {
    const Eigen::VectorXd variance = guess.of_view.cwiseAbs2();
    const double rho = guess.rho;
    const Eigen::Index columns = own_ + system_ + 1, states = variance.size();
    Eigen::Index rows = target.priors.rows();
    for (const View& view : target.views) rows += view.columns.rows();
    Eigen::MatrixXd filtered(std::max(rows, columns), columns);
    filtered.bottomRows(filtered.rows() - rows).setZero();
    filtered.topRows(target.priors.rows()) = target.priors;
    for (Eigen::Index k = 0; k < target.priors.rows(); ++k) {
      if (target.free[static_cast<size_t>(k)] < 0) continue;
      const double u = guess.of_target[target.free[static_cast<size_t>(k)]];
      filtered.row(k) /= u;
      *logs += 2 * std::log(u);
    }
    Eigen::Index row = target.priors.rows();
    Eigen::MatrixXd state = Eigen::MatrixXd::Zero(states, columns), innovation;
    Small covariance = variance.asDiagonal();
    bool first = true;
    for (const View& view : target.views) {
      if (!first) {
        state *= rho;
        covariance *= rho * rho;
        covariance.diagonal() += (1 - rho * rho) * variance;
      }
      first = false;
      const Eigen::Index n = view.columns.rows();
      // A few rows each: coefficient by coefficient is faster than what is made for large matrices.
      const Small across = covariance.lazyProduct(view.effects.transpose());
      Small spread = view.effects.lazyProduct(across);
      spread.diagonal().array() += 1;
      const Eigen::LLT<Small> llt(spread);
      innovation = view.columns - view.effects.lazyProduct(state);
      const Small whitening = llt.matrixL().solve(Small::Identity(n, n));
      const Small whitened = whitening.lazyProduct(across.transpose());
      filtered.middleRows(row, n) = whitening.lazyProduct(innovation);
      state += whitened.transpose().lazyProduct(filtered.middleRows(row, n));
      covariance -= whitened.transpose().lazyProduct(whitened);
      for (Eigen::Index k = 0; k < n; ++k) *logs += 2 * std::log(llt.matrixLLT()(k, k));
      row += n;
    }
    return filtered;
  }

  std::vector<Ordered> targets_;
  std::vector<int> quantities_;  // of view scope
  Eigen::MatrixXd system_priors_;
  Eigen::Index own_ = 0, system_ = 0;
  bool sound_ = true;
};

// Nelder and Mead, Computer Journal 7, 1965: few parameters, and a function whose derivatives nobody needs.
Eigen::VectorXd Minimum(const std::function<double(const Eigen::VectorXd&)>& f, const Eigen::VectorXd& start,
                        double step, double* least) {
  const Eigen::Index n = start.size();
  std::vector<std::pair<double, Eigen::VectorXd>> simplex = {{f(start), start}};
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::VectorXd x = start;
    x[k] += step;
    simplex.emplace_back(f(x), x);
  }
  const auto lower = [](const auto& a, const auto& b) { return a.first < b.first; };
  for (int evaluations = static_cast<int>(n) + 1; evaluations < kMostEvaluations;) {
    std::sort(simplex.begin(), simplex.end(), lower);
    if (simplex.back().first - simplex.front().first < kSettled) break;
    Eigen::VectorXd middle = Eigen::VectorXd::Zero(n);
    for (Eigen::Index k = 0; k < n; ++k) middle += simplex[static_cast<size_t>(k)].second / static_cast<double>(n);
    const auto at = [&](double by) {
      const Eigen::VectorXd x = middle + by * (middle - simplex.back().second);
      ++evaluations;
      return std::pair{f(x), x};
    };
    auto next = at(1);
    if (next.first < simplex.front().first) next = std::min(next, at(2), lower);
    else if (next.first >= simplex[static_cast<size_t>(n) - 1].first) next = std::min(next, at(-0.5), lower);
    if (next.first < simplex.back().first) {
      simplex.back() = next;
      continue;
    }
    for (size_t k = 1; k < simplex.size(); ++k) {
      simplex[k].second = (simplex[k].second + simplex[0].second) / 2;
      simplex[k].first = f(simplex[k].second);
      ++evaluations;
    }
  }
  const auto best = std::min_element(simplex.begin(), simplex.end(), lower);
  *least = best->first;
  return best->second;
}

}  // namespace

NeighboursFound EstimateNeighbours(Problem* problem, const Estimate& at, Variances* variances) {
  for (const Quantity& q : problem->quantities)
    if (q.scope == Scope::kView && q.role == Role::kConsider && !q.in_order) return {};
  Problem free = *problem;
  const std::vector<int> considered = problem->With({Scope::kSystem, Scope::kTarget}, Role::kConsider);
  for (const int k : considered) free.quantities[k].role = Role::kEstimate;
  free.AddPriors(considered);
  const std::vector<int> held = problem->With({Scope::kTarget}, Role::kHold);
  std::vector<std::string> sources;
  for (const int k : held) {
    free.quantities[k].role = Role::kEstimate;
    free.quantities[k].u = 1;
    const std::string source = std::string(kPrior) + free.quantities[k].Source();
    if (std::find(sources.begin(), sources.end(), source) == sources.end()) sources.push_back(source);
  }
  free.AddPriors(held);
  Estimate there = NominalStart(free);
  for (size_t t = 0; t < problem->targets.size(); ++t) SetValues(free, Values(*problem, at, t), t, &there);
  const Likelihood likelihood(free, there, sources);
  if (!likelihood.sound()) return {};
  const std::vector<int>& all = likelihood.quantities();
  Eigen::VectorXd u(std::ssize(all));
  std::vector<Eigen::Index> estimated;
  for (Eigen::Index k = 0; k < u.size(); ++k) {
    const Quantity& q = problem->quantities[all[static_cast<size_t>(k)]];
    u[k] = q.u;
    if (std::find(variances->sources.begin(), variances->sources.end(), q.Source()) != variances->sources.end())
      estimated.push_back(k);
  }
  // In logarithms, from what independent views gave; what those had at zero begins small. Last, the correlation.
  const Eigen::Index of_view = std::ssize(estimated), of_target = std::ssize(sources), last = of_view + of_target;
  const auto unpack = [&](const Eigen::VectorXd& x) {
    Guess guess{u, x.segment(of_view, of_target).array().exp(), std::tanh(x[last])};
    for (Eigen::Index k = 0; k < of_view; ++k) guess.of_view[estimated[static_cast<size_t>(k)]] = std::exp(x[k]);
    return guess;
  };
  const auto f = [&](const Eigen::VectorXd& x) {
    const double value = likelihood.At(unpack(x));
    return std::isfinite(value) ? value : std::numeric_limits<double>::max();
  };
  const auto minimise = [&](Eigen::VectorXd* x, bool targets, bool correlation) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index k = 0; k <= last; ++k)
      if (k < of_view || (k < last ? targets : correlation)) free.push_back(k);
    const auto of_free = [&](const Eigen::VectorXd& values) {
      Eigen::VectorXd all_values = *x;
      all_values(free) = values;
      return f(all_values);
    };
    double least = 0;
    (*x)(free) = Minimum(of_free, (*x)(free), 0.7, &least);
    return least;
  };
  Eigen::VectorXd white = Eigen::VectorXd::Zero(last + 1);
  for (Eigen::Index k = 0; k < of_view; ++k)
    white[k] = std::log(std::max(u[estimated[static_cast<size_t>(k)]], kSmall));
  white.segment(of_view, of_target).setConstant(std::log(kSmall));
  Eigen::VectorXd best = white;
  best[last] = std::atanh(0.5);
  const double correlated = minimise(&best, false, true);
  if (!(f(white) - correlated > kSignificant)) return {};
  if (of_target > 0) {
    Eigen::VectorXd smooth = white;
    double least = f(smooth);
    for (Eigen::VectorXd other = smooth; other[of_view] < 0;) {
      other.segment(of_view, of_target).array() += std::log(10);
      if (const double value = f(other); value < least) {
        least = value;
        smooth = other;
      }
    }
    least = minimise(&smooth, true, false);
    if (least < correlated) {
      best = smooth;
      best[last] = std::atanh(0.5);
      if (!(least - minimise(&best, true, true) > kSignificant)) {
        const Eigen::Index most = [&] {
          Eigen::Index k = 0;
          smooth.segment(of_view, of_target).maxCoeff(&k);
          return k;
        }();
        if (!(std::exp(smooth[of_view + most]) > kSmall)) return {};  // rounding
        const std::string& prior = sources[static_cast<size_t>(most)];
        return {NeighboursFound::kSmooth, 0, prior.substr(kPrior.size()), std::exp(smooth[of_view + most])};
      }
    }
  }
  const Guess found = unpack(best);
  const double rho = found.rho;
  if (rho < kLeastCorrelation) return {};
  if (likelihood.views() * (1 - rho) < kFewestStretches * (1 + rho)) return {NeighboursFound::kTooSlow, rho, "", 0};
  const double fewer = (3 + rho * rho) / (1 - rho * rho);
  for (Eigen::Index k = 0; k < u.size(); ++k) {
    Quantity& q = problem->quantities[all[static_cast<size_t>(k)]];
    q.u = found.of_view[k];
    q.neighbour = rho;
    for (size_t s = 0; s < variances->sources.size(); ++s) {
      if (variances->sources[s] != q.Source()) continue;
      const auto i = static_cast<Eigen::Index>(s);
      // As precise, relatively, as it was, or as so many views tell a variance.
      const double before = variances->variance[i],
                   relative = before > 0 ? variances->covariance(i, i) / (before * before) : 0;
      variances->variance[i] = q.u * q.u;
      variances->covariance.row(i).setZero();
      variances->covariance.col(i).setZero();
      variances->covariance(i, i) =
          std::pow(q.u, 4) * fewer * std::min(std::max(relative, 2 / likelihood.views()), 8 / likelihood.views());
    }
  }
  Weigh(problem, at);
  return {NeighboursFound::kNoise, rho, "", 0};
}

Eigen::MatrixXd AcrossNeighbours(const Problem& problem, const Estimate& fit, const Linearization& linear,
                                 size_t target, const Eigen::MatrixXd& columns) {
  Eigen::MatrixXd across = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
  std::vector<int> alike;
  for (int k = 0; k < std::ssize(problem.quantities); ++k)
    if (problem.quantities[k].neighbour > 0) alike.push_back(k);
  if (alike.empty()) return across;
  Eigen::VectorXd u(std::ssize(alike)), rho = u;
  for (Eigen::Index k = 0; k < u.size(); ++k) {
    u[k] = problem.quantities[alike[static_cast<size_t>(k)]].u;
    rho[k] = problem.quantities[alike[static_cast<size_t>(k)]].neighbour;
  }
  const std::vector<double> values = Values(problem, fit, target);
  const LinearTarget& rows = linear.targets[target];
  Eigen::MatrixXd before = Eigen::MatrixXd::Zero(columns.cols(), u.size());  // sum of rho^distance times those before
  for (size_t v = 0; v < problem.targets[target].views.size(); ++v) {
    const Block& view = problem.targets[target].views[v];
    if (!view.prior.empty()) continue;
    const Eigen::MatrixXd scores = columns.middleRows(rows.first[v], view.size()).transpose() *
                                   view.Weighted(RawDerivatives(view, values, alike)) * u.asDiagonal();
    before *= rho.asDiagonal();
    across += before * scores.transpose() + scores * before.transpose();
    before += scores;
  }
  return across;
}

}  // namespace scancal
