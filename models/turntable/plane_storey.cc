#include "models/turntable/plane_storey.h"
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include "models/parts/triangle.h"
#include "models/turntable/smooth_columns.h"
#include "solver/triangular_factor.h"

namespace scancal {
namespace {

// By inverse iteration, which keeps the small value's relative accuracy.
double SmallestSingularValue(const Eigen::Matrix3d& r) {
  if (!(r(0, 0) > 0) || !(r(1, 1) > 0) || !(r(2, 2) > 0)) return 0;
  const auto upper = r.triangularView<Eigen::Upper>();
  Eigen::Vector3d v = upper.solve(Eigen::Vector3d(0, 0, 1));
  double sigma = 0;
  for (int k = 0; k < 30; ++k) {
    v.normalize();
    const Eigen::Vector3d w = upper.transpose().solve(v);
    const double next = 1 / w.norm();  // sigma of w / |w|
    v = upper.solve(w);
    if (std::abs(next - sigma) <= 1e-13 * next) return next;
    sigma = next;
  }
  return sigma;
}

}  // namespace

PlaneStorey::PlaneStorey(const std::vector<Profile>& profiles, turntable::System system) {
  TriangularFactor factor(6);
  Eigen::Matrix<double, Eigen::Dynamic, 6> rows;
  for (const Turntable::View& profile : PlaneViews(profiles, system)) {
    rows.resize(std::ssize(profile.points), 6);
    system[Turntable::kM] = system[Turntable::kN] = 0;
    const turntable::ProfileInTable<double> at_axis = system.At(profile.alpha);
    system[Turntable::kM] = 1;
    const turntable::ProfileInTable<double> at_one = system.At(profile.alpha);
    const std::array<double, 3> p_M = at_one.Turned(at_one.origin);  // p_N is p_M a quarter turn on
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      const std::array<double, 3> p0 = PointOf(at_axis, profile, i);
      rows.row(i) << 1, p_M[0], -p_M[1], p0[0], p0[1], p0[2];
      rows.row(i) *= profile.points[i].weight;
    }
    factor.Add(rows);
  }
  const Eigen::Matrix<double, 6, 6> r = factor.R();
  const double sign = r(0, 0) < 0 ? -1 : 1;
  root_n_ = sign * r(0, 0);
  mean_ = sign * r.block<1, 5>(0, 1);
  cos_ = r.block<5, 1>(1, 1);
  sin_ = r.block<5, 1>(1, 2);
  x0_ = r.block<5, 1>(1, 3);
  y0_ = r.block<5, 1>(1, 4);
  z_ = r.block<5, 1>(1, 5);
}

Eigen::Matrix3d PlaneStorey::Centred(double M, double N) const {
  return Triangle<Vector5>(M * cos_ - N * sin_ + x0_, -M * sin_ - N * cos_ + y0_, z_);  // eq. (7), simplified
}

double PlaneStorey::Rmse(double M, double N, PlaneFit fit) const {
  const Eigen::Matrix3d r = Centred(M, N);
  if (fit == PlaneFit::kOrthogonal) return SmallestSingularValue(r) / root_n_;
  const double B = r(1, 1) > 0 ? r(1, 2) / r(1, 1) : 0, A = r(0, 0) > 0 ? (r(0, 2) - r(0, 1) * B) / r(0, 0) : 0;
  return r(2, 2) / (root_n_ * std::sqrt(A * A + B * B + 1));
}

std::pair<Eigen::Vector3d, double> PlaneStorey::FitPlane(double M, double N) const {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(Centred(M, N), Eigen::ComputeFullV);
  Eigen::Vector3d normal = svd.matrixV().col(2);
  const Eigen::Vector3d mean =
      Eigen::Vector3d(M * mean_[0] - N * mean_[1] + mean_[2], -M * mean_[1] - N * mean_[0] + mean_[3], mean_[4]) /
      root_n_;
  double distance = normal.dot(mean);
  if (distance < 0) {
    normal = -normal;
    distance = -distance;
  }
  return {normal, distance};
}

}  // namespace scancal
