// A measurement function and its derivatives at an estimate.
#pragma once
#include <ceres/jet.h>
#include <Eigen/Core>

namespace scancal {

template <int kOutputs, int kInputs>
struct Evaluated {
  Eigen::Vector<double, kOutputs> y;
  Eigen::Matrix<double, kOutputs, kInputs> sensitivity;  // dy/dx
};

// f(const T* x, T* y), by dual numbers.
template <int kOutputs, int kInputs, class F>
Evaluated<kOutputs, kInputs> Evaluate(const F& f, const Eigen::Vector<double, kInputs>& x) {
  using Jet = ceres::Jet<double, kInputs>;
  Jet in[kInputs], out[kOutputs];
  for (int k = 0; k < kInputs; ++k) in[k] = Jet(x[k], k);
  f(in, out);
  Evaluated<kOutputs, kInputs> result;
  for (int i = 0; i < kOutputs; ++i) {
    result.y[i] = out[i].a;
    result.sensitivity.row(i) = out[i].v.transpose();
  }
  return result;
}

}  // namespace scancal
