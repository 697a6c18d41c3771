// Decompositions of dense matrices: Eigen's, compiled once, for wherever they are instantiated each takes a compiler
// from 3 (QR) to 40 seconds (its divide-and-conquer SVD).
#pragma once
#include <Eigen/Geometry>
#include <vector>

namespace scancal {

// R (n x n, upper triangular) of rows = Q R with at least as many rows as columns, |R x| = |rows x|; by Householder
// reflections (Golub and Van Loan, Matrix Computations, 2013, 5.2).
Eigen::MatrixXd UpperTriangle(const Eigen::Ref<const Eigen::MatrixXd>& rows);

struct ThinQr {
  Eigen::MatrixXd q, r;  // m x n with orthonormal columns, n x n upper triangular
};
ThinQr QrOf(const Eigen::MatrixXd& matrix);  // m x n, m >= n

struct Svd {               // matrix = u diag(values) v'
  Eigen::MatrixXd u;       // m x min(m, n)
  Eigen::VectorXd values;  // min(m, n), descending
  Eigen::MatrixXd v;       // n x min(m, n)
};
// m x n; by one-sided rotations (Golub and Van Loan, 8.6.3), which small values survive.
Svd SvdOf(const Eigen::MatrixXd& matrix);

Eigen::Matrix3d NearestOrthogonal(const Eigen::Matrix3d& matrix);  // u v' (Golub and Van Loan, 6.4.1)

struct SymmetricEigen {    // symmetric = vectors diag(values) vectors'
  Eigen::VectorXd values;  // ascending
  Eigen::MatrixXd vectors;
};
SymmetricEigen EigenOf(const Eigen::MatrixXd& symmetric);

// Symmetric and positive definite: matrix = L L' (Golub and Van Loan, 4.2).
class Cholesky {
 public:
  explicit Cholesky(const Eigen::MatrixXd& matrix);
  bool ok() const { return ok_; }                              // positive definite
  const Eigen::MatrixXd& L() const { return l_; }              // lower triangular
  Eigen::MatrixXd Solve(const Eigen::MatrixXd& b) const;       // X of L L' X = B
  Eigen::MatrixXd SolveLower(const Eigen::MatrixXd& b) const;  // X of L X = B

 private:
  Eigen::MatrixXd l_;
  bool ok_;
};

// X of A X = B with a regular square A, by elimination with pivots in a column (Golub and Van Loan, 3.4).
Eigen::MatrixXd SolveSquare(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

// Columns of a matrix that are linearly independent, the longest rest first, until rests are below `tolerance` of the
// first (QR with pivots of columns, Golub and Van Loan, 5.4.2).
std::vector<Eigen::Index> IndependentColumns(const Eigen::MatrixXd& matrix, double tolerance);
// Q' rows, with the columns of Q a basis of what is orthogonal to the columns of `of`, by the same.
Eigen::MatrixXd ProjectOut(const Eigen::MatrixXd& of, const Eigen::MatrixXd& rows);

// X of least norm among those with least |A X - B|, by complete orthogonal decomposition (Golub and Van Loan, 5.5).
Eigen::MatrixXd LeastSquares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

// The rigid motion with the least sum of |motion from_k - onto_k|^2, columns of 3 x n (Umeyama, IEEE PAMI 13, 1991,
// 376).
Eigen::Isometry3d MotionOnto(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& onto);

// R (n x n, upper triangular) with |R t| = |F t| for every t, of a tall matrix F that is never held: rows are added in
// any number, factors of parts of F merge. By Householder QR of the stacked rows (Lawson and Hanson, Solving Least
// Squares Problems, 1974, ch. 27), never by F'F, which would lose the cost of a good fit (6 % at 0.5 um noise). The
// order of rows and merges changes R by rounding and signs only.
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
