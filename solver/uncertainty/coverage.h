// Quantiles and probabilities of the distributions that an uncertainty statement needs.
#pragma once

namespace scancal {

// k with P(|t| <= k) = coverage for Student's t (GUM G.3); dof may be fractional; infinite below 1.
double CoverageFactor(double coverage, double dof);
// P(F >= f) with dof1, dof2 degrees of freedom.
double FUpperTail(double f, double dof1, double dof2);

}  // namespace scancal
