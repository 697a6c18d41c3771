// Any number of rows, kept as a small triangle that has the same norms.
#pragma once
#include <Eigen/Core>

namespace scancal {

// R (n x n, upper triangular) with |R t| = |F t| for every t, of a tall matrix F that is never held: rows are added in
// any number, factors of parts of F merge. By Householder QR of the stacked rows (Lawson and
// Hanson, Solving Least Squares Problems, 1974, ch. 27), never by F'F, which would lose the
// cost of a good fit (6 % at 0.5 um noise). The order of rows and merges changes R by rounding and signs only.
class TriangularFactor {
 public:
  explicit TriangularFactor(int columns);
  void Add(const Eigen::Ref<const Eigen::MatrixXd>& rows);  // any number of rows x columns
  void Merge(const TriangularFactor& other);
  const Eigen::MatrixXd& R() const;  // folds what is still pending

 private:
  void Fold() const;
  // R on top, then rows that wait: folding blocks of a few hundred rows costs half of folding them one by one.
  mutable Eigen::MatrixXd stack_;
  mutable Eigen::Index filled_;
  mutable Eigen::MatrixXd r_;
};

}  // namespace scancal
