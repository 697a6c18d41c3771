#include "solver/linearize.h"
#include <glog/logging.h>
#include <algorithm>
#include "solver/dense.h"

namespace scancal {
namespace {

void Eliminate(const Eigen::MatrixXd& own, Eigen::MatrixXd system, LinearTarget* target) {
  const Eigen::Index rows = own.rows(), n = own.cols();
  if (rows < n) {
    target->own_determined = false;
    target->system_left = std::move(system);
    return;
  }
  ThinQr qr = QrOf(own);
  target->q = std::move(qr.q);
  target->own_factor = std::move(qr.r);
  for (Eigen::Index k = 0; k < n; ++k)
    if (std::abs(target->own_factor(k, k)) <= kRankTolerance * own.col(k).norm()) target->own_determined = false;
  target->coupling = target->q.transpose() * system;
  system -= target->q * target->coupling;
  // Twice is enough (Parlett, The Symmetric Eigenvalue Problem, 1980, 6.9): what is left may be 1e-8 of the whole.
  system -= target->q * (target->q.transpose() * system).eval();
  target->system_left = std::move(system);
}

constexpr double kNoEffect = 1e-9;   // relative to a quantity's effect before elimination: rounding
constexpr double kTakesPart = 0.05;  // of a unit vector

// All data rows of a target as they look from one point; its views are parts of them.
class AffineRows final : public Rows {
 public:
  struct Shared {
    std::vector<double> q0;
    std::vector<int> column;  // per quantity, -1: derivative not known
    Eigen::VectorXd r0;
    Eigen::MatrixXd jacobian;
  };
  AffineRows(std::shared_ptr<const Shared> shared, Eigen::Index first, Eigen::Index size, int points, double count,
             std::shared_ptr<const Rows> part_of = nullptr)
      : shared_(std::move(shared)),
        first_(first),
        size_(size),
        points_(points),
        count_(count),
        part_of_(std::move(part_of)) {}
  int size() const override { return static_cast<int>(size_); }
  int points() const override { return points_; }
  double count() const override { return count_; }
  std::pair<const Rows*, int> PartOf() const override { return {part_of_.get(), static_cast<int>(first_)}; }
  void Evaluate(const double* q, const double* point, std::span<const int> seeds, double* r,
                double* jacobian) const override {
    CHECK(!point) << "affine rows do not take values of single points";
    const auto by = [&](size_t quantity) {
      CHECK_GE(shared_->column[quantity], 0) << "affine rows do not know the derivative by quantity " << quantity;
      return shared_->jacobian.col(shared_->column[quantity]).segment(first_, size_);
    };
    auto residual = Eigen::VectorXd::Map(r, size_);
    residual = shared_->r0.segment(first_, size_);
    for (size_t k = 0; k < shared_->q0.size(); ++k)
      if (q[k] != shared_->q0[k]) residual += (q[k] - shared_->q0[k]) * by(k);
    for (size_t k = 0; jacobian && k < seeds.size(); ++k)
      Eigen::VectorXd::Map(jacobian + static_cast<Eigen::Index>(k) * size_, size_) = by(static_cast<size_t>(seeds[k]));
  }

 private:
  std::shared_ptr<const Shared> shared_;
  Eigen::Index first_, size_;
  int points_;
  double count_;
  std::shared_ptr<const Rows> part_of_;
};

// Puts affine rows in the place of a target's data rows.
void MakeAffine(std::vector<double> at, std::span<const int> known, Target* target) {
  auto shared = std::make_shared<AffineRows::Shared>();
  shared->q0 = std::move(at);
  shared->column.assign(shared->q0.size(), -1);
  for (size_t k = 0; k < known.size(); ++k) shared->column[known[k]] = static_cast<int>(k);
  Eigen::Index rows = 0;
  int points = 0;
  double count = 0;
  for (const Block& view : target->views) {
    if (!view.prior.empty()) continue;
    rows += view.rows->size();
    points += view.rows->points();
    count += view.rows->count();
  }
  shared->r0.resize(rows);
  shared->jacobian.resize(rows, std::ssize(known));
  const auto all = std::make_shared<AffineRows>(shared, 0, rows, points, count);
  rows = 0;
  Eigen::VectorXd r;
  Eigen::MatrixXd jacobian;
  for (Block& view : target->views) {
    if (!view.prior.empty()) continue;
    Block{view.rows, 1, {}, {}, {}}.Evaluate(shared->q0.data(), known, &r, &jacobian);
    shared->r0.segment(rows, r.size()) = r;
    shared->jacobian.middleRows(rows, r.size()) = jacobian;
    view.rows = std::make_shared<AffineRows>(shared, rows, r.size(), view.rows->points(), view.rows->count(), all);
    rows += r.size();
  }
}

// How many of these blocks, from the first on, are all the rows of something larger, in its order; 0: they are not.
size_t CountOfWhole(std::span<const Block> blocks) {
  const Rows* const whole = blocks[0].rows->PartOf().first;
  int row = 0;
  for (size_t k = 0; k < blocks.size() && whole; ++k) {
    const Block& block = blocks[k];
    if (block.rows->PartOf() != std::pair{whole, row} || block.size() != block.rows->size()) return 0;
    row += block.size();
    if (row == whole->size()) return k + 1;
  }
  return 0;
}

// As the blocks one by one.
void EvaluateWhole(std::span<const Block> blocks, const std::vector<double>& values, std::span<const int> seeds,
                   Eigen::VectorXd* r, Eigen::MatrixXd* jacobian) {
  const Rows& whole = *blocks[0].rows->PartOf().first;
  r->resize(whole.size());
  if (jacobian) jacobian->resize(whole.size(), std::ssize(seeds));
  whole.Evaluate(values.data(), nullptr, seeds, r->data(), jacobian && !seeds.empty() ? jacobian->data() : nullptr);
  const double weight = blocks[0].weight;
  const bool alike = std::all_of(blocks.begin(), blocks.end(), [&](const Block& block) {
    return block.weight == weight && !block.mix.size() && !block.offset.size();
  });
  if (alike) {
    *r *= weight;
    if (jacobian) *jacobian *= weight;
    return;
  }
  Eigen::Index at = 0;
  for (const Block& block : blocks) {
    auto own_r = r->segment(at, block.size());
    if (block.mix.size()) own_r = block.mix * own_r;
    own_r *= block.weight;
    if (block.offset.size()) own_r += block.offset;
    if (jacobian) {
      auto own_jacobian = jacobian->middleRows(at, block.size());
      if (block.mix.size()) own_jacobian = block.mix * own_jacobian;
      own_jacobian *= block.weight;
    }
    at += block.size();
  }
}

}  // namespace

void Stack(std::span<const Block> blocks, const std::vector<double>& values, std::span<const int> seeds,
           Eigen::VectorXd* r, Eigen::MatrixXd* jacobian, std::vector<Eigen::Index>* first) {
  Eigen::Index rows = 0;
  for (const Block& block : blocks) {
    if (first) first->push_back(rows);
    rows += block.size();
  }
  if (first) first->push_back(rows);
  if (!blocks.empty() && CountOfWhole(blocks) == blocks.size())
    return EvaluateWhole(blocks, values, seeds, r, jacobian);
  r->resize(rows);
  if (jacobian) jacobian->resize(rows, std::ssize(seeds));
  Eigen::VectorXd part_r;
  Eigen::MatrixXd part_jacobian;
  Eigen::Index at = 0;
  while (!blocks.empty()) {
    const size_t count = std::max<size_t>(1, CountOfWhole(blocks));
    if (count == 1) {
      blocks[0].Evaluate(values.data(), seeds, &part_r, jacobian ? &part_jacobian : nullptr);
    } else {
      EvaluateWhole(blocks.first(count), values, seeds, &part_r, jacobian ? &part_jacobian : nullptr);
    }
    r->segment(at, part_r.size()) = part_r;
    if (jacobian) jacobian->middleRows(at, part_r.size()) = part_jacobian;
    at += part_r.size();
    blocks = blocks.subspan(count);
  }
}

Linearization Linearize(const Problem& problem, const Estimate& at, Storey storey) {
  const std::vector<int> system = problem.With({Scope::kSystem}, Role::kEstimate);
  const std::vector<int> own = problem.With({Scope::kTarget}, Role::kEstimate);
  std::vector<int> seeds = system;
  seeds.insert(seeds.end(), own.begin(), own.end());
  const auto n = std::ssize(system);
  Linearization linear;
  linear.system_norm.setZero(n);
  TriangularFactor factor(static_cast<int>(n) + 1);
  for (size_t t = 0; t <= problem.targets.size(); ++t) {
    const bool priors = t == problem.targets.size();
    const std::span<const Block> blocks = priors                     ? problem.priors
                                          : storey == Storey::kNodes ? problem.targets[t].nodes
                                                                     : problem.targets[t].views;
    LinearTarget& target = linear.targets.emplace_back();
    if (blocks.empty()) continue;
    Eigen::MatrixXd jacobian;
    Stack(blocks, Values(problem, at, priors ? 0 : t), priors ? system : seeds, &target.r, &jacobian, &target.first);
    linear.cost += target.r.squaredNorm();
    linear.system_norm += jacobian.leftCols(n).colwise().squaredNorm().transpose();
    Eliminate(jacobian.rightCols(jacobian.cols() - n), jacobian.leftCols(n), &target);
    Eigen::MatrixXd with_r(target.r.size(), n + 1);
    with_r << target.system_left, target.r;
    factor.Add(with_r);
  }
  linear.system_norm = linear.system_norm.cwiseSqrt();
  linear.factor = factor.R().topLeftCorner(n, n);
  linear.rhs = factor.R().topRightCorner(n, 1);
  return linear;
}

Estimate GaussNewtonStep(const Linearization& linear) {
  Estimate step;
  step.system = -linear.factor.triangularView<Eigen::Upper>().solve(linear.rhs);
  for (size_t t = 0; t + 1 < linear.targets.size(); ++t) {
    const LinearTarget& target = linear.targets[t];
    const Eigen::VectorXd rhs = target.q.transpose() * target.r + target.coupling * step.system;
    step.targets.emplace_back(-target.own_factor.triangularView<Eigen::Upper>().solve(rhs));
  }
  return step;
}

void Add(const Estimate& step, Estimate* x) {
  x->system += step.system;
  for (size_t t = 0; t < x->targets.size(); ++t) x->targets[t] += step.targets[t];
}

double StepLength(const Linearization& linear) {
  double squared = linear.rhs.squaredNorm();
  for (const LinearTarget& target : linear.targets)
    if (target.q.size()) squared += (target.q.transpose() * target.r).squaredNorm();
  return std::sqrt(squared);
}

Observability Observe(const Problem& problem, const Linearization& linear) {
  Observability result;
  for (size_t t = 0; t < problem.targets.size(); ++t)
    if (!linear.targets[t].own_determined) result.undetermined_targets.push_back(problem.targets[t].name);
  const std::vector<int> system = problem.With({Scope::kSystem}, Role::kEstimate);
  if (system.empty()) return result;
  const Eigen::VectorXd scale = linear.system_norm.cwiseMax(1e-300).cwiseInverse();
  const Svd svd = SvdOf(linear.factor * scale.asDiagonal());
  result.singular = svd.values;
  const Eigen::Index last = result.singular.size() - 1;
  result.condition = result.singular[0] / result.singular[last];
  result.weakest = svd.v.col(last);
  for (size_t k = 0; k < system.size(); ++k) {
    bool found = false;
    for (Eigen::Index i = 0; i <= last; ++i)
      found |= result.singular[i] < kNoEffect && std::abs(svd.v(static_cast<Eigen::Index>(k), i)) > kTakesPart;
    if (found) result.undetermined.push_back(problem.quantities[system[k]].name);
  }
  return result;
}

std::vector<std::string> HoldUndetermined(std::span<const int> candidates, double part, const Linearization& linear,
                                          Problem* problem) {
  const std::vector<int> estimated = problem->With({Scope::kSystem}, Role::kEstimate);
  std::vector<std::string> held;
  Eigen::MatrixXd basis(linear.factor.rows(), 0);
  const auto take = [&](int k) {  // what is left of its column; Gram and Schmidt twice (Parlett 1980, 6.9)
    const auto c = std::find(estimated.begin(), estimated.end(), k) - estimated.begin();
    Eigen::VectorXd left = linear.factor.col(c);
    for (int again = 0; again < 2; ++again) left -= basis * (basis.transpose() * left).eval();
    const double length = left.norm();
    if (!(length > part * linear.system_norm[c])) return false;
    basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
    basis.rightCols(1) = left / length;
    return true;
  };
  const auto is_candidate = [&](int k) {
    return std::find(candidates.begin(), candidates.end(), k) != candidates.end();
  };
  for (const int k : estimated)
    if (!is_candidate(k)) take(k);
  for (const int k : candidates)
    if (!take(k)) {
      problem->quantities[k].role = Role::kHold;
      held.push_back(problem->quantities[k].name);
    }
  return held;
}

Problem Affine(const Problem& problem, const Estimate& at) {
  std::vector<int> known;
  for (int k = 0; k < std::ssize(problem.quantities); ++k) {
    const Quantity& q = problem.quantities[k];
    if (q.role == Role::kEstimate ||
        (q.role == Role::kConsider && (q.scope == Scope::kView || q.scope == Scope::kPoint)))
      known.push_back(k);
  }
  Problem affine = problem;
  for (size_t t = 0; t < affine.targets.size(); ++t) {
    Target& target = affine.targets[t];
    target.nodes = {};
    target.interpolation.clear();
    MakeAffine(Values(problem, at, t), known, &target);
  }
  return affine;
}

}  // namespace scancal
