// A problem as it looks from one point: affine in its quantities, and as cheap as that.
#pragma once
#include "solver/problem.h"

namespace scancal {

// r(q) = r(q0) + (dr/dq) (q - q0), q0 the values at `at`: for what changes the weights of a problem many times and its
// estimate hardly. Knows the derivatives of the estimated quantities and of all noise (view and point scope); the
// values of single points (Rows::Evaluate's `point`) it does not take. Views only, no nodes.
Problem Affine(const Problem& problem, const Estimate& at);

}  // namespace scancal
