#include "solver/uncertainty/misfit.h"
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include "solver/uncertainty/coverage.h"
#include "solver/weigh.h"

namespace scancal {
namespace {

constexpr double kVisible =
    1e-6;  // of a column's length: what is left of it when the estimated quantities are taken out

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

// Weighted columns of all instances of a source, target by target: rows of target t in columns that are its own, or
// everybody's where the system shares them. Free of what is estimated: B - X X'B.
class Columns {
 public:
  Columns(const Problem& problem, const Estimate& fit, const Linearization& linear, const Source& source)
      : linear_(linear), shared_(source.scope == Scope::kSystem), members_(std::ssize(source.quantities)) {
    const auto targets = std::ssize(problem.targets);
    const auto n = linear.factor.cols();
    scores_.setZero(n, instances(targets));
    for (std::ptrdiff_t t = 0; t < targets; ++t) {
      const LinearTarget& target = linear.targets[t];
      Eigen::MatrixXd b = Eigen::MatrixXd::Zero(target.r.size(), members_);
      const std::vector<double> values = Values(problem, fit, static_cast<size_t>(t));
      for (size_t v = 0; v < problem.targets[t].views.size(); ++v) {
        const Block& view = problem.targets[t].views[v];
        if (view.prior.empty())
          b.middleRows(target.first[v], target.first[v + 1] - target.first[v]) =
              view.Weighted(RawDerivatives(view, values, source.quantities));
      }
      length_ = std::max(length_, b.colwise().norm().maxCoeff());
      b -= target.q * (target.q.transpose() * b);
      scores_.middleCols(First(t), members_) += target.system_left.transpose() * b;
      of_target_.push_back(std::move(b));
    }
    const auto upper = linear.factor.triangularView<Eigen::Upper>();
    moves_ = -upper.solve(upper.transpose().solve(scores_));
    for (std::ptrdiff_t t = 0; t < std::ssize(linear.targets); ++t) left_.push_back(Left(t));
  }

  Eigen::Index instances() const { return moves_.cols(); }
  const Eigen::MatrixXd& moves() const { return moves_; }  // system x instances: dx / dq
  double length() const { return length_; }
  // R of all columns and of -r: |R (m, 1)| = |r + B m|.
  Eigen::MatrixXd Triangle() const {
    Eigen::Index rows = 0;
    for (const Eigen::MatrixXd& left : left_) rows += left.rows();
    Eigen::MatrixXd stacked(rows, instances() + 1);
    Eigen::Index at = 0;
    for (size_t t = 0; t < left_.size(); ++t) {
      stacked.middleRows(at, left_[t].rows()) << left_[t], linear_.targets[t].r;
      at += left_[t].rows();
    }
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(stacked);
    const Eigen::Index n = std::min(rows, stacked.cols());
    Eigen::MatrixXd triangle = Eigen::MatrixXd::Zero(stacked.cols(), stacked.cols());
    triangle.topRows(n) = qr.matrixQR().topRows(n).triangularView<Eigen::Upper>();
    return triangle;
  }

 private:
  Eigen::Index instances(std::ptrdiff_t targets) const { return shared_ ? members_ : members_ * targets; }
  Eigen::Index First(std::ptrdiff_t target) const { return shared_ ? 0 : members_ * target; }
  // Rows of one target, all instances: its own columns, less what the system takes up of everybody's.
  Eigen::MatrixXd Left(std::ptrdiff_t target) const {
    const LinearTarget& rows = linear_.targets[target];
    if (rows.r.size() == 0) return Eigen::MatrixXd(0, instances());
    Eigen::MatrixXd left = rows.system_left * moves_;
    if (target < std::ssize(of_target_)) left.middleCols(First(target), members_) += of_target_[target];
    return left;
  }

  const Linearization& linear_;
  bool shared_;
  Eigen::Index members_;
  double length_ = 0;
  std::vector<Eigen::MatrixXd> of_target_, left_;
  Eigen::MatrixXd scores_, moves_;
};

// The directions of m that the residuals see: m = directions * c, c independent with `deviation`, and its values.
struct Seen {
  Eigen::MatrixXd directions;
  Eigen::VectorXd value, variance;  // of c
};

Seen See(const Columns& columns) {
  const Eigen::MatrixXd triangle = columns.Triangle();
  const Eigen::Index n = columns.instances();
  const Eigen::MatrixXd r = triangle.topLeftCorner(n, n);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(r, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Index rank = 0;
  while (rank < n && svd.singularValues()[rank] > kVisible * columns.length()) ++rank;
  Seen seen;
  seen.directions = svd.matrixV().leftCols(rank);
  const Eigen::ArrayXd singular = svd.singularValues().head(rank).array();
  seen.value = -((svd.matrixU().transpose() * triangle.topRightCorner(n, 1)).col(0).head(rank).array() / singular);
  seen.variance = singular.square().inverse();
  return seen;
}

}  // namespace

std::vector<Misfit> TestMisfits(const Problem& problem, const Estimate& fit, const Linearization& linear,
                                double noise_dof) {
  std::vector<Misfit> misfits;
  if (!(noise_dof >= 1)) return misfits;
  for (const Source& source : Testable(problem)) {
    const Columns columns(problem, fit, linear, source);
    if (!(columns.length() > 0)) continue;
    const Seen seen = See(columns);
    if (seen.value.size() == 0) continue;
    const Quantity& quantity = problem.quantities[source.quantities[0]];
    const double declared = quantity.role == Role::kConsider ? quantity.u * quantity.u : 0;
    Misfit& misfit = misfits.emplace_back();
    misfit.source = source.name;
    misfit.considered = declared > 0;
    misfit.unit = quantity.unit;
    misfit.dof1 = static_cast<double>(seen.value.size());
    misfit.dof2 = noise_dof;
    const Eigen::ArrayXd weights = (seen.variance.array() + declared).inverse();
    misfit.F = (seen.value.array().square() * weights).sum() / misfit.dof1;
    misfit.p = FUpperTail(misfit.F, misfit.dof1, misfit.dof2);
    if (columns.instances() == 1) {
      misfit.size = seen.value[0] * seen.directions(0, 0);
      misfit.moves = columns.moves().col(0) * misfit.size;
    } else {
      // Method of moments: the mean square that noise and declaration leave unexplained, equal for all instances.
      const double unexplained = std::max(0.0, (misfit.F - 1) * misfit.dof1 / weights.sum());
      misfit.size = std::sqrt(unexplained);
      misfit.moves = columns.moves().rowwise().norm() * misfit.size;
    }
  }
  const double tests = static_cast<double>(misfits.size());
  for (Misfit& misfit : misfits) misfit.p = std::min(1.0, misfit.p * tests);
  return misfits;
}

}  // namespace scancal
