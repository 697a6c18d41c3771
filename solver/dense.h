// Decompositions of dense matrices: Eigen's, compiled once, for wherever they are instantiated each takes a compiler
// from 3 (QR) to 40 seconds (its divide-and-conquer SVD).
#pragma once
#include <Eigen/Core>

namespace scancal {

// R (n x n, upper triangular) of rows = Q R with at least as many rows as columns, |R x| = |rows x|; by Householder
// reflections (Golub and Van Loan, Matrix Computations, 2013, 5.2).
Eigen::MatrixXd UpperTriangle(const Eigen::Ref<const Eigen::MatrixXd>& rows);

struct ThinQr {
  Eigen::MatrixXd q, r;  // m x n with orthonormal columns, n x n upper triangular
};
ThinQr QrOf(const Eigen::MatrixXd& matrix);  // m x n, m >= n

struct Svd {  // matrix = u diag(values) v.leftCols(values.size())'
  Eigen::MatrixXd u;       // m x min(m, n)
  Eigen::VectorXd values;  // min(m, n), descending
  Eigen::MatrixXd v;       // n x n: beyond the values, what the matrix maps to zero
};
Svd SvdOf(const Eigen::MatrixXd& matrix);  // m x n, by one-sided rotations (as before, 8.6.3): small values are right, too

struct SymmetricEigen {  // symmetric = vectors diag(values) vectors'
  Eigen::VectorXd values;  // ascending
  Eigen::MatrixXd vectors;
};
SymmetricEigen EigenOf(const Eigen::MatrixXd& symmetric);

// X of least norm among those with least |A X - B|, by complete orthogonal decomposition (as before, 5.5).
Eigen::MatrixXd LeastSquares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

}  // namespace scancal
