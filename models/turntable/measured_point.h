// From a reading to the table frame, with everything that the model knows of the system.
#pragma once
#include <Eigen/Geometry>
#include <numbers>
#include "models/turntable.h"

namespace scancal {

// p_in_table = Rz(-alpha) Rz(pi) ( Ry(tilt_y) Rx(tilt_x) p_in_sensor + (-M, N, 0)' ). mm, rad.
template <class T>
Eigen::Transform<T, 3, Eigen::Affine> TableFromSensor(const T& alpha, const T& M, const T& N, const T& tilt_x,
                                                      const T& tilt_y) {
  using Axis = Eigen::Matrix<T, 3, 1>;
  return Eigen::Transform<T, 3, Eigen::Affine>(
      Eigen::AngleAxis<T>(std::numbers::pi - alpha, Axis::UnitZ()) * Eigen::Translation<T, 3>(-M, N, T(0)) *
      Eigen::AngleAxis<T>(tilt_y, Axis::UnitY()) * Eigen::AngleAxis<T>(tilt_x, Axis::UnitX()));
}

// Where the reading (alpha; y, z) lies in the table frame, mm: the transform whose distance from a plane is
// Turntable::Residual, so what an error of a quantity did to the calibration and what it does to the point agree.
// eta: where y lies in the range of depths over which linearity is declared, from -1 to 1 (ScannedVolume::Eta); one
// reading alone cannot know that range.
template <class T>
Eigen::Matrix<T, 3, 1> MeasuredPoint(double alpha, double y, double z, double eta, const Seen<T>& q) {
  const T true_y = y * (1.0 + q[Turntable::kScaleY]) + z * q[Turntable::kShear] + eta * eta * q[Turntable::kLinearity];
  const T true_z = z * (1.0 + q[Turntable::kScaleZ]), growth = 1.0 + q[Turntable::kExpansion];
  return TableFromSensor<T>(alpha - Turntable::EncoderError(alpha, q), q[Turntable::kM] * growth,
                            q[Turntable::kN] * growth, q[Turntable::kTiltX], q[Turntable::kTiltY]) *
         Eigen::Matrix<T, 3, 1>(T(0), true_y, true_z);
}

}  // namespace scancal
