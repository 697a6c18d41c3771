#include "solver/dense.h"
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>

namespace scancal {

Eigen::MatrixXd UpperTriangle(const Eigen::Ref<const Eigen::MatrixXd>& rows) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(rows);
  return qr.matrixQR().topRows(rows.cols()).triangularView<Eigen::Upper>();
}

ThinQr QrOf(const Eigen::MatrixXd& matrix) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(matrix);
  return {qr.householderQ() * Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()),
          qr.matrixQR().topRows(matrix.cols()).triangularView<Eigen::Upper>()};
}

Svd SvdOf(const Eigen::MatrixXd& matrix) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

Eigen::Matrix3d NearestOrthogonal(const Eigen::Matrix3d& matrix) {
  const Svd svd = SvdOf(matrix);
  return svd.u * svd.v.transpose();
}

SymmetricEigen EigenOf(const Eigen::MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Cholesky::Cholesky(const Eigen::MatrixXd& matrix) {
  const Eigen::LLT<Eigen::MatrixXd> llt(matrix);
  l_ = llt.matrixL();
  ok_ = llt.info() == Eigen::Success;
}

Eigen::MatrixXd Cholesky::Solve(const Eigen::MatrixXd& b) const {
  Eigen::MatrixXd x = SolveLower(b);
  l_.triangularView<Eigen::Lower>().adjoint().solveInPlace(x);
  return x;
}

Eigen::MatrixXd Cholesky::SolveLower(const Eigen::MatrixXd& b) const {
  Eigen::MatrixXd x = b;
  l_.triangularView<Eigen::Lower>().solveInPlace(x);
  return x;
}

Eigen::MatrixXd SolveSquare(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  return Eigen::PartialPivLU<Eigen::MatrixXd>(A).solve(B);
}

std::vector<Eigen::Index> IndependentColumns(const Eigen::MatrixXd& matrix, double tolerance) {
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix);
  qr.setThreshold(tolerance);
  const auto& order = qr.colsPermutation().indices();
  return {order.begin(), order.begin() + qr.rank()};
}

Eigen::MatrixXd ProjectOut(const Eigen::MatrixXd& of, const Eigen::MatrixXd& rows) {
  if (rows.rows() == 0) return rows;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(of);
  return (qr.householderQ().adjoint() * rows).bottomRows(rows.rows() - qr.rank());
}

Eigen::MatrixXd LeastSquares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  return Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(A).solve(B);
}

Eigen::Isometry3d MotionOnto(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& onto) {
  return Eigen::Isometry3d(Eigen::umeyama(from, onto, false));
}

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
