#include "solver/uncertainty/gum.h"
#include <glog/logging.h>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

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

double CoverageFactor(double coverage, double dof) {
  if (!(dof >= 1)) return std::numeric_limits<double>::infinity();
  return boost::math::quantile(boost::math::students_t(dof), 0.5 + 0.5 * coverage);
}

double JointCoverageFactor(double coverage, double n, double dof) {
  if (!(dof >= 1)) return std::numeric_limits<double>::infinity();
  if (!std::isfinite(dof)) return std::sqrt(boost::math::quantile(boost::math::chi_squared(n), coverage));
  return std::sqrt(n * boost::math::quantile(boost::math::fisher_f(n, dof), coverage));
}

double FUpperTail(double f, double dof1, double dof2) {
  if (!(f > 0)) return 1;
  if (std::isinf(f)) return 0;
  if (std::isinf(dof2)) return boost::math::cdf(boost::math::complement(boost::math::chi_squared(dof1), f * dof1));
  return boost::math::cdf(boost::math::complement(boost::math::fisher_f(dof1, dof2), f));
}

}  // namespace scancal
