// The form of a plate that is not quite flat, as a few smooth modes.
#pragma once
#include <array>

namespace scancal {

// Orthonormal Legendre products of total degree 2 to 4 over [-1, 1]^2, each times its share of the whole: variance
// falling as degree^-4, together a mean square of one. Amplitudes of standard deviation u then are a form of u rms.
// Lower degrees are the plane itself.
inline constexpr int kFormModes = 12;
using FormModes = std::array<double, kFormModes>;
FormModes FormModesAt(double u, double v);  // u, v outside the square are taken at its edge

}  // namespace scancal
