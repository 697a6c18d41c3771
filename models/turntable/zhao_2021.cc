#include "models/turntable/zhao_2021.h"
#include <Eigen/QR>
#include <cmath>

namespace scancal::zhao_2021 {

Eigen::Vector3d Transform(double M, double N, const Measurement& p) {
  const double L = std::abs(N + p.y);                                         // (3)
  const double R = std::sqrt(M * M + L * L);                                  // (4)
  const double beta = std::atan(std::abs(M) / L);                             // (5)
  return {R * std::sin(beta - p.alpha), -R * std::cos(p.alpha - beta), p.z};  // (6), (7)
}

Plane FitPlane(const std::vector<Eigen::Vector3d>& points) {
  const auto n = std::ssize(points);
  Eigen::MatrixXd D(n, 3);
  Eigen::VectorXd delta(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    D.row(i) << points[i].x(), points[i].y(), 1;  // (9), (10)
    delta[i] = points[i].z();                     // (12)
  }
  const Eigen::Vector3d phi = D.householderQr().solve(delta);  // (13), the same minimum without forming D'D
  return {phi[0], phi[1], phi[2]};
}

double Rmse(const Plane& plane, const std::vector<Eigen::Vector3d>& points) {
  double sum = 0;
  for (const Eigen::Vector3d& p : points) {
    const double d = std::abs(plane.A * p.x() + plane.B * p.y() - p.z() + plane.C) /
                     std::sqrt(plane.A * plane.A + plane.B * plane.B + 1);
    sum += d * d;
  }
  return std::sqrt(sum / static_cast<double>(points.size()));
}

double S(double M, double N, const std::vector<std::vector<Measurement>>& placements) {
  double sum = 0;
  std::vector<Eigen::Vector3d> points;
  for (const auto& placement : placements) {
    points.clear();
    for (const Measurement& p : placement) points.push_back(Transform(M, N, p));
    sum += Rmse(FitPlane(points), points);
  }
  return sum / static_cast<double>(placements.size());
}

GridResult Search(const GridBox& box, const std::vector<std::vector<Measurement>>& placements) {
  const auto one_value = [&](const std::array<double, 2>& at, std::span<double> value) {
    value[0] = S(at[0], at[1], placements);
  };
  return GridSearch(box, 1, one_value);
}

}  // namespace scancal::zhao_2021
