// Three points that stand for all points of a profile.
#pragma once
#include <Eigen/Core>
#include <array>
#include <span>
#include "models/parts/moments.h"

namespace scancal {

struct PseudoPoint {
  double weight;  // multiplies the residual of the point: three weights of sqrt(n / 3) stand for n points
  double y, z;    // mm
};

// Upper triangular R of rows w (1, z, y); the points enter every sum of squares of functions affine in (y, z) only
// through it.
using ProfileFactor = Eigen::Matrix3d;

ProfileFactor Factor(std::span<const double> y, std::span<const double> z);
ProfileFactor Factor(std::span<const double> y, std::span<const double> z, std::span<const double> weights);

// Of all the points behind several factors.
ProfileFactor Merged(std::span<const ProfileFactor> parts);

// sum_i (w_i (a + b z_i + c y_i))^2 over the points = the same over the three, exactly, for every a, b, c.
// Equal weights at Chebyshev's nodes on the profile's own line, what is left of y across it. Not for an empty profile.
std::array<PseudoPoint, 3> PseudoPoints(const ProfileFactor& factor);

// Both ends of an evenly spaced line with this mean and spread, sqrt(3) standard deviations from its middle.
std::array<PseudoPoint, 2> Ends(const ProfileFactor& factor);

}  // namespace scancal
