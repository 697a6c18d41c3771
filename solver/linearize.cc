#include "solver/linearize.h"
#include <Eigen/QR>
#include "solver/triangular_factor.h"

namespace scancal {
namespace {

// Columns of an own Jacobian that differ from a combination of the others by less than this are not determined.
constexpr double kRankTolerance = 1e-10;

void Eliminate(const Eigen::MatrixXd& own, Eigen::MatrixXd system, LinearTarget* target) {
  const Eigen::Index rows = own.rows(), n = own.cols();
  if (rows < n) {
    target->own_determined = false;
    target->system_left = std::move(system);
    return;
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(own);
  target->q = qr.householderQ() * Eigen::MatrixXd::Identity(rows, n);
  target->own_factor = qr.matrixQR().topRows(n).triangularView<Eigen::Upper>();
  for (Eigen::Index k = 0; k < n; ++k)
    if (std::abs(target->own_factor(k, k)) <= kRankTolerance * own.col(k).norm()) target->own_determined = false;
  target->coupling = target->q.transpose() * system;
  system -= target->q * target->coupling;
  system -=
      target->q * (target->q.transpose() * system).eval();  // twice is enough: what is left may be 1e-8 of the whole
  target->system_left = std::move(system);
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
  r->resize(rows);
  if (jacobian) jacobian->resize(rows, std::ssize(seeds));
  Eigen::VectorXd block_r;
  Eigen::MatrixXd block_jacobian;
  Eigen::Index at = 0;
  for (const Block& block : blocks) {
    block.Evaluate(values.data(), seeds, &block_r, jacobian ? &block_jacobian : nullptr);
    r->segment(at, block_r.size()) = block_r;
    if (jacobian) jacobian->middleRows(at, block_r.size()) = block_jacobian;
    at += block_r.size();
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

}  // namespace scancal
