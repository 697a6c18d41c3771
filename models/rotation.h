// Rotation vectors, in honest radians.
#pragma once
#include <ceres/rotation.h>
#include <Eigen/Core>

namespace scancal {

// result = the rotation by |turn| rad about turn, applied to v. Differentiable at turn = 0.
template <class T>
void Rotate(const T turn[3], const Eigen::Vector3d& v, T result[3]) {
  const T of[3] = {T(v[0]), T(v[1]), T(v[2])};
  ceres::AngleAxisRotatePoint(turn, of, result);
}

}  // namespace scancal
