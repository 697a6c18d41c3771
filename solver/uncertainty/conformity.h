// Decisions about a tolerance where the measurement has an uncertainty.
#pragma once

namespace scancal {

enum class Decision { kAccept, kUndecided, kReject };
const char* Name(Decision decision);  // "accept", "undecided", "reject"

struct Conformity {
  double lower = 0, upper = 0;  // tolerance limits
  double guard = 0;             // width of the guard bands
  Decision decision = Decision::kUndecided;
  double p_outside = 0;  // that the true value lies outside the limits: where it is accepted, that this is false
};

// Decision rule of ISO 14253-1 for simple acceptance of what is proven: accepted where the value lies within the limits
// by more than the guard band, rejected where it lies outside by more than it, undecided between. The guard band is the
// one-sided 95 % of the value's distribution, t(dof) u, 1.65 u where dof is infinite. p_outside: of the same
// distribution about the value (JCGM 106, 7.2 and 9.3.2, without prior knowledge of the part). u > 0, lower < upper.
Conformity ConformityOf(double value, double u, double dof, double lower, double upper);

}  // namespace scancal
