// The published method as printed: Zhao et al., Sensors 2021, 21, 8359, equations (7) to (15) and Algorithm 1, point by
// point.
//
// This is the baseline, kept for comparison and as the reference that the compressed search must reproduce. Where it is
// wrong it stays wrong: eq. (7) holds for M >= 0 and N + y >= 0 only, and the plane Z = A X + B Y + C cannot be
// parallel to the axis.
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <vector>
#include "solver/dense.h"
#include "solver/grid_search.h"

namespace scancal::zhao_2021 {

struct Measurement {
  double alpha = 0, y = 0, z = 0;  // rad, mm, mm
};

// Eq. (7), with square root, arctangent and absolute values.
inline Eigen::Vector3d Transform(double M, double N, const Measurement& p) {
  const double L = std::abs(N + p.y);                                         // (3)
  const double R = std::sqrt(M * M + L * L);                                  // (4)
  const double beta = std::atan(std::abs(M) / L);                             // (5)
  return {R * std::sin(beta - p.alpha), -R * std::cos(p.alpha - beta), p.z};  // (6), (7)
}

struct Plane {  // Z = A X + B Y + C
  double A = 0, B = 0, C = 0;
};

// Eqs. (8)-(13).
inline Plane FitPlane(const std::vector<Eigen::Vector3d>& points) {
  const auto n = std::ssize(points);
  Eigen::MatrixXd D(n, 3);
  Eigen::VectorXd delta(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    D.row(i) << points[i].x(), points[i].y(), 1;  // (9), (10)
    delta[i] = points[i].z();                     // (12)
  }
  const Eigen::Vector3d phi = LeastSquares(D, delta);  // (13), the same minimum without forming D'D
  return {phi[0], phi[1], phi[2]};
}

// Eq. (14).
inline double Rmse(const Plane& plane, const std::vector<Eigen::Vector3d>& points) {
  double sum = 0;
  for (const Eigen::Vector3d& p : points) {
    const double d = std::abs(plane.A * p.x() + plane.B * p.y() - p.z() + plane.C) /
                     std::sqrt(plane.A * plane.A + plane.B * plane.B + 1);
    sum += d * d;
  }
  return std::sqrt(sum / static_cast<double>(points.size()));
}

// Eq. (15): the mean of the placements' rmse at one node.
inline double S(double M, double N, const std::vector<std::vector<Measurement>>& placements) {
  double sum = 0;
  std::vector<Eigen::Vector3d> points;
  for (const auto& placement : placements) {
    points.clear();
    for (const Measurement& p : placement) points.push_back(Transform(M, N, p));
    sum += Rmse(FitPlane(points), points);
  }
  return sum / static_cast<double>(placements.size());
}

// Algorithm 1, read as meant: N runs from c to d for every M, S starts at infinity.
inline GridResult Search(const GridBox& box, const std::vector<std::vector<Measurement>>& placements) {
  const auto one_value = [&](const std::array<double, 2>& at, std::span<double> value) {
    value[0] = S(at[0], at[1], placements);
  };
  return GridSearch(box, 1, one_value);
}

}  // namespace scancal::zhao_2021
