#include "solver/uncertainty/conformity.h"
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include "solver/uncertainty/gum.h"

namespace scancal {
namespace {

double Below(double t, double dof) {  // P(x < t)
  if (!std::isfinite(dof)) return boost::math::cdf(boost::math::normal(), t);
  return boost::math::cdf(boost::math::students_t(dof), t);
}

}  // namespace

const char* Name(Decision decision) {
  return decision == Decision::kAccept ? "accept" : decision == Decision::kReject ? "reject" : "undecided";
}

Conformity ConformityOf(double value, double u, double dof, double lower, double upper) {
  Conformity result{lower, upper};
  result.guard = CoverageFactor(1 - 2 * (1 - kCoverage), dof) * u;
  if (value >= lower + result.guard && value <= upper - result.guard) result.decision = Decision::kAccept;
  if (value < lower - result.guard || value > upper + result.guard) result.decision = Decision::kReject;
  result.p_outside = Below((lower - value) / u, dof) + Below((value - upper) / u, dof);
  return result;
}

}  // namespace scancal
