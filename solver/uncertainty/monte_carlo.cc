#include "solver/uncertainty/monte_carlo.h"
#include <glog/logging.h>
#include <algorithm>
#include <atomic>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <thread>
#include "solver/uncertainty/budget.h"
#include "solver/uncertainty/gum.h"

namespace scancal {
namespace {

constexpr double kLeastDof = 8;

double InverseChiSquared(double dof, Random* random) {  // scaled: mean dof / (dof - 2)
  return dof / boost::math::quantile(boost::math::chi_squared(dof), random->Uniform());
}

constexpr int64_t kChunk = 16;             // trials that a thread takes at a time
constexpr int kMostGaussNewtonSteps = 10;  // of Gauss-Newton, before Refine is asked
constexpr double kTolerance = 1e-6;        // of a standard uncertainty
constexpr double kLeastRatio = 1e-2;       // of two steps: two may by chance differ more than the next two

// Of the estimates. Not below the rounding of a quantity's own size (of one unit, where it is smaller), as in Refine.
Eigen::ArrayXd StandardUncertainties(const Problem& problem, const Fit& fit, const Linearization& linear) {
  const Eigen::ArrayXd least = 1e-12 / kTolerance * fit.estimate.system.array().abs().max(1.0);
  const Eigen::MatrixXd covariance = BudgetOf(problem, fit.estimate, linear).Total();
  return covariance.size() ? covariance.diagonal().array().sqrt().max(least) : least;
}

// Gauss-Newton by QR from near the minimum to where Refine would end. Each step shortens the error by about the same
// factor (Dennis and Schnabel, Numerical Methods for Unconstrained Optimization, 1983, 10.2): done when the last step,
// times its ratio to the one before, is negligible.
Fit Settle(const Problem& problem, const Estimate& from, const Eigen::ArrayXd& u) {
  Fit fit;
  fit.estimate = from;
  double before = 0;
  for (; fit.iterations < kMostGaussNewtonSteps; ++fit.iterations) {
    const Linearization linear = Linearize(problem, fit.estimate, Storey::kViews);
    if (!std::isfinite(linear.cost)) break;
    const Estimate step = GaussNewtonStep(linear);
    Add(step, &fit.estimate);
    const double length = (step.system.array().abs() / u).maxCoeff();
    const double ratio = before > 0 ? std::clamp(length / before, kLeastRatio, 1.0) : 1;
    fit.converged = length * ratio <= kTolerance;
    if (fit.converged) return fit;
    before = length;
  }
  // From a start without residuals Refine could only complain.
  return fit.iterations > 0 ? Refine(problem, from) : fit;
}

constexpr double kStandardErrors = 2;
constexpr int64_t kBlock = 10'000;  // at least 100 / (1 - kCoverage)
constexpr double kShareOfTolerance = 1 / 5.0;

double Mean(std::span<const double> x) { return Eigen::Map<const Eigen::VectorXd>(x.data(), std::ssize(x)).mean(); }

double Deviation(std::span<const double> x) {
  const Eigen::Map<const Eigen::VectorXd> all(x.data(), std::ssize(x));
  return (all.array() - all.mean()).matrix().norm() / std::sqrt(static_cast<double>(x.size()) - 1);
}

struct Range {
  double low, high;
};

// The ends of the interval, and where each lies within its standard errors. Ranks are counted from 1.
struct SymmetricInterval {
  explicit SymmetricInterval(std::span<const double> trials) : sorted(trials.begin(), trials.end()) {
    std::sort(sorted.begin(), sorted.end());
    const double m = static_cast<double>(sorted.size());
    const double q = std::floor(kCoverage * m + 0.5);
    rank_low = std::floor((m - q + 1) / 2);  // 7.7.2: (m - q) / 2 if that is whole
    rank_high = rank_low + q;
    rank_error = kStandardErrors * std::sqrt(m * (1 - kCoverage) / 2 * (1 + kCoverage) / 2);
  }
  double At(double rank) const {
    if (rank < 1) return -std::numeric_limits<double>::infinity();
    if (rank > static_cast<double>(sorted.size())) return std::numeric_limits<double>::infinity();
    return sorted[static_cast<size_t>(rank) - 1];
  }
  double Low() const { return At(rank_low); }
  double High() const { return At(rank_high); }
  Range Around(double rank) const { return {At(std::floor(rank - rank_error)), At(std::ceil(rank + rank_error))}; }

  std::vector<double> sorted;
  double rank_low, rank_high, rank_error;
};

// |end - x| <= tolerance for every x in the range, for none, or for some.
Verdict EndWithin(double end, const Range& range, double tolerance) {
  const double farthest = std::max(std::abs(end - range.low), std::abs(end - range.high));
  const double nearest = std::max({range.low - end, end - range.high, 0.0});
  return farthest <= tolerance ? Verdict::kPass : nearest > tolerance ? Verdict::kFail : Verdict::kUndecided;
}

// Mean, deviation and ends of each block, one column a block; their averages over blocks are what 7.9.4 watches.
bool IsStable(const Eigen::Ref<const Eigen::MatrixXd>& of_blocks, double tolerance) {
  const double blocks = static_cast<double>(of_blocks.cols());
  if (blocks < 2) return false;
  const Eigen::ArrayXd squares = (of_blocks.colwise() - of_blocks.rowwise().mean()).rowwise().squaredNorm();
  return (2 * (squares / (blocks * (blocks - 1))).sqrt() < tolerance).all();
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
    influences_.push_back({k, q.scope, q.u, variance, q.u, q.neighbour});
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
    for (Influence& influence : influences_) {
      if (influence.scope != scope) continue;
      const double rho = influence.neighbour;
      influence.normal = rho * influence.normal + std::sqrt(1 - rho * rho) * random->Normal();
      to[influence.quantity] = influence.drawn_u * influence.normal;
    }
  };
  const size_t quantities = problem_.quantities.size();
  std::vector<double> drawn(quantities);
  draw(Scope::kSystem, drawn.data());
  for (const auto& target : rows_) {
    draw(Scope::kTarget, drawn.data());
    for (Influence& influence : influences_)
      if (influence.neighbour > 0) influence.normal = random->Normal();  // of the view before the first
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

MonteCarloSample MonteCarlo(const Problem& problem, const Fit& fit, const Linearization& linear,
                            const VarianceDof& variance_dof, const MonteCarloOptions& options) {
  constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
  CHECK_GT(fit.estimate.system.size(), 0) << "there is nothing to estimate";
  const Eigen::ArrayXd u = StandardUncertainties(problem, fit, linear);
  Eigen::MatrixXd estimates = Eigen::MatrixXd::Constant(options.trials, fit.estimate.system.size(), kMissing);
  std::atomic<int64_t> next = 0, failed = 0;
  const auto work = [&](bool shows_progress) {
    DrawnProblem drawn(problem, fit.estimate, variance_dof);
    for (int64_t begin; (begin = next.fetch_add(kChunk)) < options.trials;) {
      if (shows_progress && options.progress)
        options.progress(static_cast<double>(begin) / static_cast<double>(options.trials));
      for (int64_t trial = begin; trial < std::min(begin + kChunk, options.trials); ++trial) {
        Random random(options.seed, static_cast<uint64_t>(options.first + trial));
        drawn.Draw(&random);
        const Fit again = Settle(drawn.problem(), fit.estimate, u);
        if (again.converged) {
          estimates.row(trial) = again.estimate.system.transpose();
        } else {
          ++failed;
        }
      }
    }
  };
  const int threads = options.threads > 0 ? options.threads : static_cast<int>(std::thread::hardware_concurrency());
  std::vector<std::jthread> others;
  for (int k = 1; k < threads; ++k) others.emplace_back(work, false);
  work(true);
  others.clear();  // joins
  Eigen::Index settled = 0;
  for (Eigen::Index trial = 0; trial < estimates.rows(); ++trial)
    if (estimates.row(trial).allFinite()) estimates.row(settled++) = estimates.row(trial);
  estimates.conservativeResize(settled, Eigen::NoChange);
  return {std::move(estimates), failed};
}

const char* Name(Verdict verdict) {
  return verdict == Verdict::kPass ? "PASS" : verdict == Verdict::kFail ? "FAIL" : "UNDECIDED";
}

double NumericalTolerance(double u, int digits) {
  if (!(u > 0) || !std::isfinite(u)) return 0;
  double last = std::floor(std::log10(u)) - (digits - 1);
  if (std::round(u / std::pow(10, last)) >= std::pow(10, digits)) ++last;  // 0.96 to one digit is 1
  return 0.5 * std::pow(10, last);
}

Validation Validate(std::span<const double> trials, const GumInterval& gum, int digits) {
  CHECK_GE(trials.size(), 40) << "fewer have no interval";
  const SymmetricInterval interval(trials);
  Validation result{Mean(trials), Deviation(trials), interval.Low(), interval.High(), 0, 0, 0, Verdict::kUndecided};
  result.d_low = std::abs(gum.value - gum.U - result.low);
  result.d_high = std::abs(gum.value + gum.U - result.high);
  result.tolerance = NumericalTolerance(gum.u, digits);
  if (result.tolerance == 0) return result;
  const Verdict low = EndWithin(gum.value - gum.U, interval.Around(interval.rank_low), result.tolerance);
  const Verdict high = EndWithin(gum.value + gum.U, interval.Around(interval.rank_high), result.tolerance);
  if (low == Verdict::kFail || high == Verdict::kFail) result.verdict = Verdict::kFail;
  if (low == Verdict::kPass && high == Verdict::kPass) result.verdict = Verdict::kPass;
  return result;
}

AdaptiveSample SampleUntilStable(const std::function<Eigen::MatrixXd(int64_t first, int64_t trials)>& sample,
                                 std::span<const GumInterval> gum, int digits, int64_t most) {
  std::vector<Eigen::MatrixXd> blocks, watched(gum.size());
  AdaptiveSample result;
  Eigen::Index rows = 0;
  for (int64_t done = 0; done < most && !result.stable; done += kBlock) {
    const Eigen::MatrixXd& block = blocks.emplace_back(sample(done, std::min(kBlock, most - done)));
    rows += block.rows();
    if (block.rows() < kBlock / 2) break;  // the rest, or most did not settle
    result.stable = true;
    for (size_t k = 0; k < gum.size(); ++k) {
      const std::span<const double> column(block.col(static_cast<Eigen::Index>(k)).data(), block.rows());
      const SymmetricInterval interval(column);
      watched[k].conservativeResize(4, watched[k].cols() + 1);
      watched[k].rightCols(1) << Mean(column), Deviation(column), interval.Low(), interval.High();
      result.stable &= IsStable(watched[k], kShareOfTolerance * NumericalTolerance(gum[k].u, digits));
    }
  }
  result.trials.resize(rows, std::ssize(gum));
  for (Eigen::Index to = 0; const Eigen::MatrixXd& block : blocks) {
    result.trials.middleRows(to, block.rows()) = block;
    to += block.rows();
  }
  return result;
}

}  // namespace scancal
