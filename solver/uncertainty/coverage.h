// Quantiles and probabilities of the distributions that an uncertainty statement needs.
#pragma once

namespace scancal {

// k with P(|t| <= k) = coverage for Student's t (GUM G.3); dof may be fractional; infinite below 1.
double CoverageFactor(double coverage, double dof);
// k of the joint region of n quantities: x with (x - x0)' C^-1 (x - x0) <= k^2 holds all of them with this coverage,
// k^2 = n F(coverage; n, dof). Larger than the k of one.
double JointCoverageFactor(double coverage, double n, double dof);
// P(F >= f) with dof1, dof2 degrees of freedom.
double FUpperTail(double f, double dof1, double dof2);

}  // namespace scancal
