#include "solver/uncertainty/misfit.h"
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include "solver/dense.h"
#include "solver/uncertainty/gum.h"
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

Visible VisibleOf(const Columns& columns, const Eigen::VectorXd& r, const Eigen::MatrixXd& considered) {
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
  Eigen::MatrixXd considered(r.size(), 0);  // all instances, times their u
  for (const Source& source : sources) {
    columns.push_back(ColumnsOf(problem, fit, linear, source));
    const Quantity& quantity = problem.quantities[source.quantities[0]];
    if (quantity.role != Role::kConsider) continue;
    const Eigen::Index before = considered.cols(), more = columns.back().left.cols();
    considered.conservativeResize(Eigen::NoChange, before + more);
    considered.rightCols(more) = columns.back().left * quantity.u;
  }
  for (size_t s = 0; s < sources.size(); ++s) {
    if (!(columns[s].length > 0) || columns[s].left.cols() > r.size()) continue;
    const Visible visible = VisibleOf(columns[s], r, considered);
    if (visible.value.size() == 0) continue;
    const Quantity& quantity = problem.quantities[sources[s].quantities[0]];
    MisfitTest& misfit = misfits.emplace_back();
    misfit.source = sources[s].name;
    misfit.considered = quantity.role == Role::kConsider;
    misfit.unit = quantity.unit;
    misfit.dof1 = static_cast<double>(visible.value.size());
    misfit.dof2 = noise_dof;
    const Eigen::LLT<Eigen::MatrixXd> covariance(visible.covariance);
    misfit.F = visible.value.dot(covariance.solve(visible.value)) / misfit.dof1;
    misfit.p = FUpperTail(misfit.F, misfit.dof1, misfit.dof2);
    if (columns[s].left.cols() == 1) {
      misfit.size = visible.value[0] * visible.directions(0, 0);
      misfit.moves = Plain(columns[s].moves.col(0) * misfit.size);
    } else {
      // Method of moments (Searle, Casella and McCulloch, Variance Components, 1992, ch. 5): the mean square that noise
      // and declaration leave unexplained, equal for all instances.
      const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(visible.value.size(), visible.value.size());
      misfit.size = std::sqrt(std::max(0.0, (misfit.F - 1) * misfit.dof1 / covariance.solve(identity).trace()));
      misfit.moves = Plain(columns[s].moves.rowwise().norm() * misfit.size);
    }
  }
  const double tests = static_cast<double>(misfits.size());
  for (MisfitTest& misfit : misfits) misfit.p = std::min(1.0, misfit.p * tests);
  return misfits;
}

Neighbours CorrelationOfNeighbours(const Problem& problem, const Estimate& fit, const Linearization& linear) {
  const std::vector<int> of_view = problem.With({Scope::kView}, Role::kConsider);
  double products = 0, squares_of_products = 0, squares = 0;
  for (size_t t = 0; t < problem.targets.size(); ++t) {
    const std::vector<double> values = Values(problem, fit, t);
    const LinearTarget& target = linear.targets[t];
    Eigen::VectorXd before;
    for (size_t v = 0; v < problem.targets[t].views.size(); ++v) {
      const Block& view = problem.targets[t].views[v];
      if (!view.prior.empty()) continue;
      const Eigen::MatrixXd effects = view.Weighted(RawDerivatives(view, values, of_view)).colwise().normalized();
      const Eigen::VectorXd z = effects.transpose() * target.r.segment(target.first[v], effects.rows());
      squares += z.squaredNorm();
      if (before.size()) {
        products += z.dot(before);
        squares_of_products += z.dot(before) * z.dot(before);
      }
      before = z;
    }
  }
  if (!(squares > 0)) return {};
  return {products / squares, std::sqrt(squares_of_products) / squares};
}

}  // namespace scancal
