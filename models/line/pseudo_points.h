// Three points that stand for all points of a line.
#pragma once
#include <Eigen/Core>
#include <array>
#include <span>
#include "models/line/moments.h"

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

// R (upper triangular, its diagonal not negative) of the columns (a, b, c) = Q R, by modified Gram-Schmidt: R is as
// exact as Householder's (Bjorck 1967). R(2, 2) is the norm of what a and b leave of c.
template <class Vector>
Eigen::Matrix3d Triangle(Vector a, Vector b, Vector c) {
  Eigen::Matrix3d r = Eigen::Matrix3d::Zero();
  r(0, 0) = a.norm();
  if (r(0, 0) > 0) a /= r(0, 0);
  r(0, 1) = a.dot(b);
  b -= r(0, 1) * a;
  r(0, 2) = a.dot(c);
  c -= r(0, 2) * a;
  r(1, 1) = b.norm();
  if (r(1, 1) > 0) b /= r(1, 1);
  r(1, 2) = b.dot(c);
  c -= r(1, 2) * b;
  r(2, 2) = c.norm();
  return r;
}

// Both ends of an evenly spaced line with this mean and spread, sqrt(3) standard deviations from its middle.
std::array<PseudoPoint, 2> Ends(const ProfileFactor& factor);

}  // namespace scancal
