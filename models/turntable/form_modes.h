// The form of a plate that is not quite flat, as a few smooth modes.
#pragma once
#include <array>

namespace scancal {

// Orthonormal Legendre products of total degree 2 to 4 over [-1, 1]^2, each times its share of the whole, together a
// mean square of one: amplitudes of standard deviation u then are a form of u rms. Lower degrees are the plane itself.
// A plate bends alike per mm in all directions, so where the rectangle is `aspect` times as long in u as in v the
// variance of degrees (i, j) falls as (i + aspect j)^-4; over a square as (total degree)^-4.
inline constexpr int kFormModes = 12;
using FormModes = std::array<double, kFormModes>;
FormModes FormModesAt(double u, double v, double aspect);  // u, v outside the square are taken at its edge

}  // namespace scancal
