// A few rows of three columns as a triangle.
#pragma once
#include <Eigen/Core>

namespace scancal {

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

}  // namespace scancal
