#include "solver/uncertainty/law_of_propagation.h"
#include <glog/logging.h>
#include <cmath>

namespace scancal {

Eigen::MatrixXd PropagateCovariance(const Eigen::MatrixXd& sensitivity, const Eigen::MatrixXd& covariance) {
  CHECK_EQ(sensitivity.cols(), covariance.rows());
  return sensitivity * covariance * sensitivity.transpose();
}

Eigen::MatrixXd Correlations(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd inverse_u = covariance.diagonal().cwiseSqrt().cwiseInverse();
  return inverse_u.asDiagonal() * covariance * inverse_u.asDiagonal();
}

double EffectiveDof(std::span<const double> contributions, std::span<const double> dofs) {
  CHECK_EQ(contributions.size(), dofs.size());
  double variance = 0, sum = 0;
  for (size_t i = 0; i < dofs.size(); ++i) {
    variance += contributions[i] * contributions[i];
    sum += std::pow(contributions[i], 4) / dofs[i];
  }
  return variance * variance / sum;
}

}  // namespace scancal
