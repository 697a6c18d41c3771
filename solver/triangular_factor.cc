#include "solver/triangular_factor.h"
#include <algorithm>
#include "solver/dense.h"

namespace scancal {

TriangularFactor::TriangularFactor(int columns)
    : stack_(Eigen::MatrixXd::Zero(columns + std::max(64, 8 * columns), columns)),
      filled_(columns),
      r_(Eigen::MatrixXd::Zero(columns, columns)) {}

void TriangularFactor::Add(const Eigen::Ref<const Eigen::MatrixXd>& rows) {
  for (Eigen::Index done = 0; done < rows.rows();) {
    if (filled_ == stack_.rows()) Fold();
    const Eigen::Index n = std::min(rows.rows() - done, stack_.rows() - filled_);
    stack_.middleRows(filled_, n) = rows.middleRows(done, n);
    filled_ += n;
    done += n;
  }
}

void TriangularFactor::Merge(const TriangularFactor& other) { Add(other.R()); }

const Eigen::MatrixXd& TriangularFactor::R() const {
  Fold();
  return r_;
}

void TriangularFactor::Fold() const {
  const Eigen::Index columns = stack_.cols();
  if (filled_ == columns) return;
  r_ = UpperTriangle(stack_.topRows(filled_));
  stack_.topRows(columns) = r_;
  filled_ = columns;
}

}  // namespace scancal
