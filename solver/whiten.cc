#include "solver/whiten.h"
#include <glog/logging.h>
#include <Eigen/Cholesky>

namespace scancal {

Eigen::MatrixXd Whitening(const Eigen::MatrixXd& covariance) {
  const Eigen::LLT<Eigen::MatrixXd> llt(covariance);
  CHECK(llt.info() == Eigen::Success) << "a covariance must be positive definite: every row needs noise of its own";
  return llt.matrixL().solve(Eigen::MatrixXd::Identity(covariance.rows(), covariance.cols()));
}

}  // namespace scancal
