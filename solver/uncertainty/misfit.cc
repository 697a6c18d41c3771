#include "solver/uncertainty/misfit.h"
#include <algorithm>
#include <cmath>
#include <functional>
#include "solver/dense.h"
#include "solver/uncertainty/gum.h"
#include "solver/uncertainty/neighbours.h"
#include "solver/weigh.h"

namespace scancal {
namespace {

// Of a column's length: what must be left of it when the estimated quantities are taken out. Less is noise of where the
// points were measured (a tenth of a millimetre in a mode of a plate leaves 1e-4), and correlates with the residuals.
constexpr double kVisible = 5e-3;

struct Source {
  std::string name;
  std::vector<int> quantities;
  Scope scope;
};

std::vector<Source> Testable(const Problem& problem) {
  std::vector<Source> sources;
  for (int k = 0; k < std::ssize(problem.quantities); ++k) {
    const Quantity& q = problem.quantities[k];
    if (q.role == Role::kEstimate || (q.scope != Scope::kSystem && q.scope != Scope::kTarget)) continue;
    const auto found =
        std::find_if(sources.begin(), sources.end(), [&](const Source& s) { return s.name == q.Source(); });
    if (found == sources.end()) {
      sources.push_back({q.Source(), {k}, q.scope});
    } else {
      found->quantities.push_back(k);
    }
  }
  return sources;
}

// All instances of a source as columns over all rows, weighted, without what the estimated quantities explain: B - X
// X'B. One column a quantity where the system shares it, else one for every target.
struct Columns {
  Eigen::MatrixXd left;   // rows x instances
  Eigen::MatrixXd moves;  // system x instances: d estimate / d q
  double length = 0;      // of the longest column before
};

Columns ColumnsOf(const Problem& problem, const Estimate& fit, const Linearization& linear, const Source& source) {
  const auto targets = std::ssize(problem.targets), members = std::ssize(source.quantities);
  const bool shared = source.scope == Scope::kSystem;
  const auto first_instance = [&](std::ptrdiff_t t) { return shared ? 0 : members * t; };
  Columns columns;
  Eigen::Index rows = 0;
  for (const LinearTarget& target : linear.targets) rows += target.r.size();
  columns.left.setZero(rows, shared ? members : members * targets);
  Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(linear.factor.cols(), columns.left.cols());
  Eigen::Index at = 0;
  for (std::ptrdiff_t t = 0; t < targets; ++t) {
    const LinearTarget& target = linear.targets[t];
    const std::vector<double> values = Values(problem, fit, static_cast<size_t>(t));
    auto b = columns.left.block(at, first_instance(t), target.r.size(), members);
    for (size_t v = 0; v < problem.targets[t].views.size(); ++v) {
      const Block& view = problem.targets[t].views[v];
      if (view.prior.empty())
        b.middleRows(target.first[v], target.first[v + 1] - target.first[v]) =
            view.Weighted(RawDerivatives(view, values, source.quantities));
    }
    columns.length = std::max(columns.length, b.colwise().norm().maxCoeff());
    b -= target.q * (target.q.transpose() * b).eval();
    scores.middleCols(first_instance(t), members) += target.system_left.transpose() * b;
    at += target.r.size();
  }
  const auto upper = linear.factor.triangularView<Eigen::Upper>();
  columns.moves = -upper.solve(upper.transpose().solve(scores));
  at = 0;
  for (const LinearTarget& target : linear.targets) {
    if (target.r.size() > 0) columns.left.middleRows(at, target.r.size()) += target.system_left * columns.moves;
    at += target.r.size();
  }
  return columns;
}

// All instances of those sources that are considered, times their u. columns: of each source.
Eigen::MatrixXd ConsideredColumns(const Problem& problem, const std::vector<Source>& sources,
                                  const std::vector<Columns>& columns, Eigen::Index rows) {
  Eigen::MatrixXd considered(rows, 0);
  for (size_t s = 0; s < sources.size(); ++s) {
    const std::vector<int>& quantities = sources[s].quantities;
    if (problem.quantities[quantities[0]].role != Role::kConsider) continue;
    const Eigen::Index before = considered.cols(), more = columns[s].left.cols();
    Eigen::VectorXd u(more);
    for (Eigen::Index k = 0; k < more; ++k)
      u[k] = problem.quantities[quantities[static_cast<size_t>(k) % quantities.size()]].u;
    considered.conservativeResize(Eigen::NoChange, before + more);
    considered.rightCols(more) = columns[s].left * u.asDiagonal();
    if (!problem.quantities[quantities[0]].perhaps_shared) continue;
    const auto members = std::ssize(quantities);
    Eigen::MatrixXd one = Eigen::MatrixXd::Zero(rows, members);
    for (Eigen::Index first = 0; first < more; first += members) one += considered.middleCols(before + first, members);
    considered.conservativeResize(Eigen::NoChange, before + more + members);
    considered.rightCols(members) = one;
  }
  return considered;
}

Eigen::VectorXd Residuals(const Linearization& linear) {
  Eigen::Index rows = 0;
  for (const LinearTarget& target : linear.targets) rows += target.r.size();
  Eigen::VectorXd r(rows);
  Eigen::Index at = 0;
  for (const LinearTarget& target : linear.targets) {
    r.segment(at, target.r.size()) = target.r;
    at += target.r.size();
  }
  return r;
}

// What the residuals see of the instances m: m = directions * value, and the covariance of `value` from the noise and
// from everything that was considered.
struct Visible {
  Eigen::MatrixXd directions;
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance;
};

Visible VisibleOf(const Columns& columns, const Eigen::VectorXd& r, const Eigen::MatrixXd& considered,
                  const std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>& across_neighbours) {
  const ThinQr qr = QrOf(columns.left);
  const Eigen::Index n = columns.left.cols();
  const Svd svd = SvdOf(qr.r);
  Eigen::Index rank = 0;
  while (rank < n && svd.values[rank] > kVisible * columns.length) ++rank;
  const Eigen::VectorXd inverse = svd.values.head(rank).cwiseInverse();
  const auto fitted = [&](const Eigen::MatrixXd& to) -> Eigen::MatrixXd {
    return -(inverse.asDiagonal() * svd.u.leftCols(rank).transpose() * (qr.q.transpose() * to));
  };
  Visible visible;
  visible.directions = svd.v.leftCols(rank);
  visible.value = fitted(r);
  visible.covariance = inverse.cwiseAbs2().asDiagonal();
  visible.covariance += across_neighbours(qr.q * (svd.u.leftCols(rank) * inverse.asDiagonal()));
  if (considered.cols() > 0 && rank > 0) {
    const Eigen::MatrixXd of_considered = fitted(considered);
    visible.covariance += of_considered * of_considered.transpose();
  }
  return visible;
}

}  // namespace

std::vector<MisfitTest> TestMisfits(const Problem& problem, const Estimate& fit, const Linearization& linear,
                                    double noise_dof) {
  std::vector<MisfitTest> misfits;
  if (!(noise_dof >= 1)) return misfits;
  const Eigen::VectorXd r = Residuals(linear);
  const std::vector<Source> sources = Testable(problem);
  std::vector<Columns> columns;
  for (const Source& source : sources) columns.push_back(ColumnsOf(problem, fit, linear, source));
  const Eigen::MatrixXd considered = ConsideredColumns(problem, sources, columns, r.size());
  const auto across_neighbours = [&](const Eigen::MatrixXd& sums) {
    Eigen::MatrixXd across = Eigen::MatrixXd::Zero(sums.cols(), sums.cols());
    Eigen::Index at = 0;
    for (size_t t = 0; t < problem.targets.size(); ++t) {
      const Eigen::Index rows = linear.targets[t].r.size();
      across += AcrossNeighbours(problem, fit, linear, t, sums.middleRows(at, rows));
      at += rows;
    }
    return across;
  };
  for (size_t s = 0; s < sources.size(); ++s) {
    if (!(columns[s].length > 0) || columns[s].left.cols() > r.size()) continue;
    const Visible visible = VisibleOf(columns[s], r, considered, across_neighbours);
    if (visible.value.size() == 0) continue;
    const Quantity& quantity = problem.quantities[sources[s].quantities[0]];
    MisfitTest& misfit = misfits.emplace_back();
    misfit.source = sources[s].name;
    misfit.considered = quantity.role == Role::kConsider;
    misfit.unit = quantity.unit;
    misfit.dof1 = static_cast<double>(visible.value.size());
    misfit.dof2 = noise_dof;
    const Cholesky covariance(visible.covariance);
    misfit.F = covariance.SolveLower(visible.value).squaredNorm() / misfit.dof1;
    misfit.p = FUpperTail(misfit.F, misfit.dof1, misfit.dof2);
    if (columns[s].left.cols() == 1) {
      misfit.size = visible.value[0] * visible.directions(0, 0);
      misfit.moves = Plain(columns[s].moves.col(0) * misfit.size);
    } else {
      // Method of moments (Searle, Casella and McCulloch, Variance Components, 1992, ch. 5): the mean square that noise
      // and declaration leave unexplained, equal for all instances.
      const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(visible.value.size(), visible.value.size());
      misfit.size = std::sqrt(std::max(0.0, (misfit.F - 1) * misfit.dof1 / covariance.Solve(identity).trace()));
      misfit.moves = Plain(columns[s].moves.rowwise().norm() * misfit.size);
    }
  }
  const double tests = static_cast<double>(misfits.size());
  for (MisfitTest& misfit : misfits) misfit.p = std::min(1.0, misfit.p * tests);
  return misfits;
}

Change FindChange(const Problem& problem, const Estimate& fit, const Linearization& linear, double noise_dof,
                  const std::vector<std::pair<size_t, size_t>>& order, const std::vector<int>& quantities) {
  Change best;
  const auto n = std::ssize(quantities);
  if (!(noise_dof >= 1) || n == 0) return best;
  const Eigen::VectorXd r = Residuals(linear);
  std::vector<Source> sources = Testable(problem);
  std::erase_if(sources, [&](const Source& s) { return problem.quantities[s.quantities[0]].role != Role::kConsider; });
  std::vector<Columns> columns;
  for (const Source& source : sources) columns.push_back(ColumnsOf(problem, fit, linear, source));
  const Eigen::MatrixXd considered = ConsideredColumns(problem, sources, columns, r.size());
  std::vector<Eigen::Index> first;  // row of each target
  std::vector<std::vector<double>> values;
  Eigen::Index rows = 0;
  for (size_t t = 0; t < problem.targets.size(); ++t) {
    first.push_back(rows);
    rows += linear.targets[t].r.size();
    values.push_back(Values(problem, fit, t));
  }
  // Sums over the views from a place on: B'B, B'(r, considered), and per target Q'B; over all targets L'B and the sum
  // of (Q'B)'Q'B. B: the columns of the quantities, L: the target's rows of the system, Q: of its own quantities.
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(n, n), explained = squares;
  Eigen::MatrixXd on_data = Eigen::MatrixXd::Zero(n, 1 + considered.cols());
  Eigen::MatrixXd on_system = Eigen::MatrixXd::Zero(linear.factor.cols(), n);
  std::vector<Eigen::MatrixXd> on_own;
  for (const LinearTarget& target : linear.targets) on_own.push_back(Eigen::MatrixXd::Zero(target.q.cols(), n));
  const auto upper = linear.factor.triangularView<Eigen::Upper>();
  double places = 0;
  const size_t least = std::max<size_t>(4, order.size() / 20);
  if (order.size() < 2 * least) return best;
  for (size_t place = order.size() - 1; place > 0; --place) {
    const auto [t, v] = order[place];
    const LinearTarget& target = linear.targets[t];
    const Block& view = problem.targets[t].views[v];
    const Eigen::Index at = target.first[v], size = target.first[v + 1] - at;
    const Eigen::MatrixXd b = view.Weighted(RawDerivatives(view, values[t], quantities));
    squares += b.transpose() * b;
    on_data.col(0) += b.transpose() * r.segment(first[t] + at, size);
    on_data.rightCols(considered.cols()) += b.transpose() * considered.middleRows(first[t] + at, size);
    on_system += target.system_left.middleRows(at, size).transpose() * b;
    explained -= on_own[t].transpose() * on_own[t];
    on_own[t] += target.q.middleRows(at, size).transpose() * b;
    explained += on_own[t].transpose() * on_own[t];
    if (std::min(place, order.size() - place) < least) continue;
    const Eigen::MatrixXd by_system = upper.transpose().solve(on_system);
    const Eigen::VectorXd scale = squares.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const SymmetricEigen eigen =
        EigenOf(scale.asDiagonal() * (squares - explained - by_system.transpose() * by_system) * scale.asDiagonal());
    std::vector<Eigen::Index> seen;
    for (Eigen::Index k = 0; k < n; ++k)
      if (eigen.values[k] > kVisible * kVisible) seen.push_back(k);
    if (seen.empty()) continue;
    ++places;
    const Eigen::MatrixXd basis = eigen.vectors(Eigen::all, seen);
    const Eigen::MatrixXd score = basis.transpose() * scale.asDiagonal() * on_data;
    Eigen::MatrixXd covariance = eigen.values(seen).asDiagonal();
    covariance += score.rightCols(considered.cols()) * score.rightCols(considered.cols()).transpose();
    const double dof = static_cast<double>(seen.size());
    const double F = Cholesky(covariance).SolveLower(score.col(0)).squaredNorm() / dof;
    const double p = FUpperTail(F, dof, noise_dof);
    if (p > best.p || (p == best.p && F < best.F)) continue;
    const Eigen::VectorXd step =
        -(scale.asDiagonal() * (basis * score.col(0).cwiseQuotient(eigen.values(seen).eval())));
    best = {place, F, dof, p, Plain(step), Plain(upper.solve(by_system * step))};
  }
  best.p = std::min(1.0, best.p * places);
  return best;
}

bool Neighbours::IsSignificant() const {
  constexpr double kFarFromIndependent = 4;  // standard errors
  constexpr double kLeastCorrelation = 0.1;
  return correlation >= std::max(kFarFromIndependent * standard_error, kLeastCorrelation);
}

bool Neighbours::IsSuspected() const {
  constexpr double kFar = 4;
  return IsSignificant() || wandering > kFar;
}

Neighbours CorrelationOfNeighbours(const Problem& problem, const Estimate& fit, const Linearization& linear) {
  constexpr double kForgets[] = {0, 0.8, 0.95};
  const std::vector<int> of_view = problem.With({Scope::kView}, Role::kConsider);
  double products = 0, squares_of_products = 0, squares = 0;
  Eigen::ArrayXXd sums = Eigen::ArrayXXd::Zero(std::ssize(of_view), std::size(kForgets)), spread = sums;
  for (size_t t = 0; t < problem.targets.size(); ++t) {
    const std::vector<double> values = Values(problem, fit, t);
    const LinearTarget& target = linear.targets[t];
    Eigen::VectorXd before;
    Eigen::ArrayXXd smooth = 0 * sums;
    for (size_t v = 0; v < problem.targets[t].views.size(); ++v) {
      const Block& view = problem.targets[t].views[v];
      if (!view.prior.empty()) continue;
      const Eigen::MatrixXd effects = view.Weighted(RawDerivatives(view, values, of_view)).colwise().normalized();
      const Eigen::VectorXd z = effects.transpose() * target.r.segment(target.first[v], effects.rows());
      squares += z.squaredNorm();
      for (Eigen::Index k = 0; k < sums.cols(); ++k) {
        const Eigen::ArrayXd product = z.array() * smooth.col(k);
        sums.col(k) += product;
        spread.col(k) += product.square();
        smooth.col(k) = kForgets[k] * smooth.col(k) + z.array();
      }
      if (before.size()) {
        products += z.dot(before);
        squares_of_products += z.dot(before) * z.dot(before);
      }
      before = z;
    }
  }
  if (!(squares > 0)) return {};
  const double wandering = (spread > 0).select(sums / spread.max(1e-300).sqrt(), 0.0).maxCoeff();
  return {products / squares, std::sqrt(squares_of_products) / squares, wandering};
}

}  // namespace scancal
