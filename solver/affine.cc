#include "solver/affine.h"
#include <glog/logging.h>

namespace scancal {
namespace {

class AffineRows final : public Rows {
 public:
  AffineRows(const Rows& rows, std::vector<double> q0, std::span<const int> known)
      : q0_(std::move(q0)),
        column_(q0_.size(), -1),
        r0_(rows.size()),
        jacobian_(rows.size(), std::ssize(known)),
        points_(rows.points()),
        count_(rows.count()) {
    for (size_t k = 0; k < known.size(); ++k) column_[known[k]] = static_cast<int>(k);
    rows.Evaluate(q0_.data(), nullptr, known, r0_.data(), known.empty() ? nullptr : jacobian_.data());
  }
  int size() const override { return static_cast<int>(r0_.size()); }
  int points() const override { return points_; }
  double count() const override { return count_; }
  void Evaluate(const double* q, const double* point, std::span<const int> seeds, double* r,
                double* jacobian) const override {
    CHECK(!point) << "affine rows do not take values of single points";
    auto residual = Eigen::VectorXd::Map(r, r0_.size());
    residual = r0_;
    for (size_t k = 0; k < q0_.size(); ++k) {
      if (q[k] == q0_[k]) continue;
      CHECK_GE(column_[k], 0) << "affine rows do not know the derivative by quantity " << k;
      residual += (q[k] - q0_[k]) * jacobian_.col(column_[k]);
    }
    for (size_t k = 0; jacobian && k < seeds.size(); ++k) {
      CHECK_GE(column_[seeds[k]], 0) << "affine rows do not know the derivative by quantity " << seeds[k];
      Eigen::VectorXd::Map(jacobian + static_cast<Eigen::Index>(k) * r0_.size(), r0_.size()) =
          jacobian_.col(column_[seeds[k]]);
    }
  }

 private:
  std::vector<double> q0_;
  std::vector<int> column_;  // per quantity, -1: derivative not known
  Eigen::VectorXd r0_;
  Eigen::MatrixXd jacobian_;
  int points_;
  double count_;
};

}  // namespace

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
    const std::vector<double> values = Values(problem, at, t);
    for (Block& view : target.views)
      if (view.prior.empty()) view.rows = std::make_shared<AffineRows>(*view.rows, values, known);
  }
  return affine;
}

}  // namespace scancal
