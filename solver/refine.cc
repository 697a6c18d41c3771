#include "solver/refine.h"
#include <ceres/ceres.h>
#include <glog/logging.h>
#include <algorithm>
#include <optional>
#include "solver/dense.h"

namespace scancal {
namespace {

constexpr Message<> kSingular{"solver.singular", "the equations are singular", "die Gleichungen sind singulär"};
constexpr Message<> kStillMoves{"solver.still_moves",
                                "the last step is still larger than a thousandth of the uncertainty",
                                "der letzte Schritt ist noch größer als ein Tausendstel der Unsicherheit"};
constexpr Message<int> kOutOfSteps{"solver.out_of_steps", "no convergence after {} iterations",
                                   "keine Konvergenz nach {} Iterationen"};

constexpr int kStepsFromStart = 12;
constexpr int kPolishSteps = 100;     // large residuals let Gauss-Newton gain a fifth of a digit a step
constexpr double kNegligible = 1e-3;  // of a standard uncertainty
constexpr double kLeastRatio = 1e-2;  // of two steps: two may by chance differ more than the next two
constexpr double kSettled = 1e-10;    // of a standard uncertainty: nothing is left to gain

// All rows of a target as Ceres sees them: a function of the system's estimated quantities and the target's own.
class BlocksCost final : public ceres::CostFunction {
 public:
  BlocksCost(const Problem& problem, std::span<const Block> blocks, const std::vector<int>& system,
             const std::vector<int>& own)
      : blocks_(blocks), system_(std::ssize(system)), own_(std::ssize(own)), seeds_(system) {
    seeds_.insert(seeds_.end(), own.begin(), own.end());
    for (const Quantity& quantity : problem.quantities) values_.push_back(quantity.value);
    int rows = 0;
    for (const Block& block : blocks) rows += block.size();
    set_num_residuals(rows);
    for (const Eigen::Index n : {system_, own_})
      if (n) mutable_parameter_block_sizes()->push_back(static_cast<int>(n));
  }

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    std::vector<double> q = values_;
    for (Eigen::Index k = 0; k < system_; ++k) q[seeds_[k]] = x[0][k];
    for (Eigen::Index k = 0; k < own_; ++k) q[seeds_[system_ + k]] = x[system_ ? 1 : 0][k];
    Eigen::VectorXd r;
    Eigen::MatrixXd jacobian;
    Stack(blocks_, q, seeds_, &r, jacobians ? &jacobian : nullptr);
    Eigen::VectorXd::Map(residuals, r.size()) = r;
    for (size_t b = 0; jacobians && b < parameter_block_sizes().size(); ++b) {
      if (!jacobians[b]) continue;
      const bool of_system = system_ && b == 0;
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      if (of_system) {
        RowMajor::Map(jacobians[b], r.size(), system_) = jacobian.leftCols(system_);
      } else {
        RowMajor::Map(jacobians[b], r.size(), own_) = jacobian.rightCols(own_);
      }
    }
    return r.allFinite();
  }

 private:
  std::span<const Block> blocks_;
  Eigen::Index system_, own_;
  std::vector<int> seeds_;
  std::vector<double> values_;
};

// All estimated quantities in one piece, the targets' in order, the system's last: Ceres orders its blocks by their
// addresses, and the order decides the last digits.
class Parameters {
 public:
  explicit Parameters(const Estimate& x) : system_(x.system.size()), own_(x.targets.empty() ? 0 : x.targets[0].size()) {
    for (const Eigen::VectorXd& own : x.targets) values_.insert(values_.end(), own.begin(), own.end());
    values_.insert(values_.end(), x.system.begin(), x.system.end());
  }
  double* Own(size_t target) { return values_.data() + static_cast<Eigen::Index>(target) * own_; }
  double* System() { return values_.data() + std::ssize(values_) - system_; }
  void CopyTo(Estimate* x) {
    for (size_t t = 0; t < x->targets.size(); ++t) x->targets[t] = Eigen::VectorXd::Map(Own(t), own_);
    x->system = Eigen::VectorXd::Map(System(), system_);
  }

 private:
  Eigen::Index system_, own_;
  std::vector<double> values_;
};

ceres::LinearSolverType SchurOf(const Problem& problem, Elimination elimination) {
  constexpr size_t kManyTargets = 100;
  const bool sparse = elimination == Elimination::kSparse ||
                      (elimination == Elimination::kByTargets && problem.targets.size() > kManyTargets);
  return sparse ? ceres::SPARSE_SCHUR : ceres::DENSE_SCHUR;
}

ceres::Solver::Summary SolveByCeres(const Problem& problem, Storey storey, const RefineOptions& choice, Estimate* x) {
  const std::vector<int> system = problem.With({Scope::kSystem}, Role::kEstimate);
  const std::vector<int> own = problem.With({Scope::kTarget}, Role::kEstimate);
  Parameters at(*x);
  ceres::Problem ceres_problem;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (size_t t = 0; t < problem.targets.size(); ++t) {
    const Target& target = problem.targets[t];
    const std::span<const Block> blocks = storey == Storey::kNodes ? target.nodes : target.views;
    std::vector<double*> parameters;
    if (!system.empty()) parameters.push_back(at.System());
    if (!own.empty()) parameters.push_back(at.Own(t));
    if (parameters.empty() || blocks.empty()) continue;
    ceres_problem.AddResidualBlock(new BlocksCost(problem, blocks, system, own), nullptr, parameters);
    if (!own.empty()) ordering->AddElementToGroup(at.Own(t), 0);
  }
  if (!system.empty()) {
    if (!problem.priors.empty())
      ceres_problem.AddResidualBlock(new BlocksCost(problem, problem.priors, system, {}), nullptr, at.System());
    ordering->AddElementToGroup(at.System(), own.empty() ? 0 : 1);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = system.empty() || own.empty() ? ceres::DENSE_QR : SchurOf(problem, choice.elimination);
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.linear_solver_ordering = ordering;
  options.max_num_iterations = choice.max_iterations;
  // Starts are near: Gauss-Newton at once, and Levenberg-Marquardt only where that fails.
  options.initial_trust_region_radius = 1e8;
  options.function_tolerance = options.parameter_tolerance = 1e-12;
  options.gradient_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  at.CopyTo(x);
  return summary;
}

// A Gauss-Newton step with what its end is judged by.
struct NextStep {
  Estimate step;
  double cost = 0;    // where it begins
  double length = 0;  // |J step|, see StepLength
};

NextStep ByRows(const Problem& problem, const Estimate& at, Storey storey) {
  const Linearization linear = Linearize(problem, at, storey);
  return {GaussNewtonStep(linear), linear.cost, StepLength(linear)};
}

// Cholesky of products of columns that are scaled to unit length. Nothing where so little is left of one that the step
// would lose more than half of its digits.
class ScaledProducts {
 public:
  explicit ScaledProducts(const Eigen::MatrixXd& products, const Eigen::VectorXd& squares)
      : scale_(squares.cwiseMax(1e-300).cwiseSqrt().cwiseInverse()),
        products_(scale_.asDiagonal() * products * scale_.asDiagonal()) {}
  bool ok() const {
    constexpr double kLeft = 1e-4;
    return products_.ok() && (products_.L().diagonal().array() > kLeft).all();
  }
  Eigen::MatrixXd Solve(const Eigen::MatrixXd& b) const {
    return scale_.asDiagonal() * products_.Solve(scale_.asDiagonal() * b);
  }

 private:
  Eigen::VectorXd scale_;
  Cholesky products_;
};

struct Buffers {  // to be used again: they are large
  Eigen::VectorXd r;
  Eigen::MatrixXd jacobian;
};

// The same by products of the columns: several times faster than by QR, and where the columns are far from dependent
// the step that is left at the end is as small, because it is computed anew from the residuals (Bjorck, Numerical
// Methods for Least Squares Problems, 1996, 6.6.5). Nothing where they are not.
std::optional<NextStep> ByProducts(const Problem& problem, const Estimate& at, Storey storey, Buffers* buffers) {
  const std::vector<int> system = problem.With({Scope::kSystem}, Role::kEstimate);
  const std::vector<int> own = problem.With({Scope::kTarget}, Role::kEstimate);
  std::vector<int> seeds = system;
  seeds.insert(seeds.end(), own.begin(), own.end());
  const auto n = std::ssize(system), p = std::ssize(own);
  struct OfTarget {
    std::optional<ScaledProducts> products;
    Eigen::MatrixXd coupling;  // (own, system)
    Eigen::VectorXd pull;      // of own
  };
  std::vector<OfTarget> targets;
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd pull = Eigen::VectorXd::Zero(n), squares = pull;
  NextStep next;
  auto& [r, jacobian] = *buffers;
  for (size_t t = 0; t < problem.targets.size(); ++t) {
    Stack(storey == Storey::kNodes ? problem.targets[t].nodes : problem.targets[t].views, Values(problem, at, t), seeds,
          &r, &jacobian);
    next.cost += r.squaredNorm();
    const Eigen::MatrixXd all = jacobian.transpose() * jacobian;
    const Eigen::VectorXd of_r = jacobian.transpose() * r;
    products += all.topLeftCorner(n, n);
    squares += all.diagonal().head(n);
    pull += of_r.head(n);
    OfTarget& target = targets.emplace_back(OfTarget{{}, all.bottomLeftCorner(p, n), of_r.tail(p)});
    if (p == 0) continue;
    target.products.emplace(all.bottomRightCorner(p, p), all.diagonal().tail(p));
    if (!target.products->ok()) return std::nullopt;
    products -= target.coupling.transpose() * target.products->Solve(target.coupling);
    const Eigen::VectorXd alone = target.products->Solve(target.pull);
    pull -= target.coupling.transpose() * alone;
    next.length += target.pull.dot(alone);
  }
  if (!problem.priors.empty()) {
    Stack(problem.priors, Values(problem, at, 0), system, &r, &jacobian);
    next.cost += r.squaredNorm();
    products += jacobian.transpose() * jacobian;
    squares += jacobian.colwise().squaredNorm().transpose();
    pull += jacobian.transpose() * r;
  }
  if (n > 0) {
    const ScaledProducts left(products, squares);
    if (!left.ok()) return std::nullopt;
    next.step.system = -left.Solve(pull);
    next.length -= pull.dot(next.step.system);
  }
  for (const OfTarget& target : targets) {
    Eigen::VectorXd& step = next.step.targets.emplace_back(Eigen::VectorXd::Zero(p));
    if (p > 0)
      step = -target.products->Solve(
          target.pull + (n > 0 ? Eigen::VectorXd(target.coupling * next.step.system) : Eigen::VectorXd::Zero(p)));
  }
  next.length = std::sqrt(std::max(0.0, next.length));
  return next;
}

bool AllFinite(const Estimate& x) {
  return x.system.allFinite() &&
         std::all_of(x.targets.begin(), x.targets.end(), [](const auto& own) { return own.allFinite(); });
}

constexpr double kTiny = 1e-12, kRounding = 1e-10;

// Largest component of the step against this part of the quantity's own size (of one unit, where it is smaller).
bool IsTiny(const Estimate& step, const Estimate& x, double part) {
  const auto tiny = [&](const Eigen::VectorXd& d, const Eigen::VectorXd& of) {
    return (d.array().abs() <= part * of.array().abs().max(1.0)).all();
  };
  if (step.system.size()) return tiny(step.system, x.system);  // the targets' own follow exactly
  for (size_t t = 0; t < x.targets.size(); ++t)
    if (!tiny(step.targets[t], x.targets[t])) return false;
  return true;
}

// Gauss-Newton steps as long as they gain something; so many, or where these converge as many as there may be.
void Settle(const Problem& problem, Storey storey, int most_steps, Fit* fit) {
  Buffers buffers;
  const auto next_step = [&](const Estimate& at) {
    std::optional<NextStep> next = ByProducts(problem, at, storey, &buffers);
    return next ? *std::move(next) : ByRows(problem, at, storey);
  };
  const double count = std::max(1.0, problem.Count());
  NextStep here = next_step(fit->estimate);
  double last = std::numeric_limits<double>::infinity();
  for (int k = 0; k < most_steps || (fit->converged && k < kPolishSteps); ++k) {
    if (!AllFinite(here.step)) {
      fit->message = Say(kSingular);
      break;
    }
    // Length over noise is the relative offset of Bates and Watts (1981): no quantity moves by more of its uncertainty.
    const double noise = std::sqrt(here.cost / count);
    const bool tiny = IsTiny(here.step, fit->estimate, kTiny);
    fit->converged = tiny || here.length <= kNegligible * noise;
    // A step that is no shorter than the last is rounding; a tiny one is worth its time if it gains two digits.
    if (here.length <= kSettled * noise || (fit->converged && here.length >= (tiny ? 0.01 : 1) * last)) break;
    // Each step shortens the error by about the same factor or more (Dennis and Schnabel, Numerical Methods for
    // Unconstrained Optimization, 1983, 10.2): the next one would be nothing.
    const double ratio = std::max(here.length / last, kLeastRatio);
    const bool is_last = k > 0 && here.length * ratio <= kSettled * noise;
    last = here.length;
    Estimate next = fit->estimate;
    Add(here.step, &next);
    if (is_last) {
      fit->estimate = std::move(next);
      fit->converged = true;
      ++fit->iterations;
      here.cost -= here.length * here.length;
      break;
    }
    NextStep there = next_step(next);
    ++fit->iterations;
    // Large residuals may keep Gauss-Newton from settling better than Levenberg-Marquardt did.
    // Residuals without noise end in rounding: then the step, however small, makes nothing better.
    if (!(there.cost <= here.cost * (1 + 1e-9) + 1e-300)) {
      fit->converged |= IsTiny(here.step, fit->estimate, kRounding);
      break;
    }
    fit->estimate = std::move(next);
    here = std::move(there);
  }
  fit->cost = here.cost;
}

}  // namespace

Storey FitStorey(const Problem& problem) { return problem.NodesSuffice() ? Storey::kNodes : Storey::kViews; }

Fit Refine(const Problem& problem, const Estimate& start, const RefineOptions& options) {
  CHECK(!problem.targets.empty()) << "a problem needs a target";
  const Storey storey = FitStorey(problem);
  // A good start needs nothing else; from any other Ceres' trust region finds the way.
  Fit fit{.estimate = start, .message = {}};
  if (options.elimination == Elimination::kByTargets) {
    Settle(problem, storey, std::min(options.max_iterations, kStepsFromStart), &fit);
    if (fit.converged) return fit;
    fit = {.estimate = start, .message = {}};
  }
  const auto summary = SolveByCeres(problem, storey, options, &fit.estimate);
  fit.iterations = static_cast<int>(summary.iterations.size());
  if (!summary.IsSolutionUsable()) {
    fit.message = {summary.message};
    return fit;
  }
  Settle(problem, storey, kPolishSteps, &fit);
  if (!fit.converged && fit.message.empty())
    fit.message = summary.termination_type == ceres::CONVERGENCE ? Say(kStillMoves) : Say(kOutOfSteps, fit.iterations);
  return fit;
}

}  // namespace scancal
