#include "solver/uncertainty/coverage.h"
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

namespace scancal {

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
  return boost::math::cdf(boost::math::complement(boost::math::fisher_f(dof1, dof2), f));
}

}  // namespace scancal
