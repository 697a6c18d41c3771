#include "models/line/pseudo_points.h"
#include <glog/logging.h>
#include <cmath>
#include <numbers>
#include "solver/dense.h"

namespace scancal {

ProfileFactor Factor(std::span<const double> y, std::span<const double> z) {
  CHECK_EQ(y.size(), z.size());
  const LineFactor f = FactorLine(y.data(), z.data(), y.size());
  ProfileFactor r;
  r << f.r00, f.r01, f.r02, 0, f.r11, f.r12, 0, 0, f.r22;
  return r;
}

ProfileFactor Factor(std::span<const double> y, std::span<const double> z, std::span<const double> weights) {
  CHECK_EQ(y.size(), z.size());
  CHECK_EQ(y.size(), weights.size());
  const auto n = std::ssize(y);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(std::max<Eigen::Index>(n, 3), 3);
  for (Eigen::Index i = 0; i < n; ++i) rows.row(i) << weights[i], weights[i] * z[i], weights[i] * y[i];
  ProfileFactor r = UpperTriangle(rows);
  for (int k = 0; k < 3; ++k)
    if (r(k, k) < 0) r.row(k) = -r.row(k);
  return r;
}

ProfileFactor Merged(std::span<const ProfileFactor> parts) {
  CHECK(!parts.empty());
  constexpr int kRows = 24;  // of eight factors: all segments of a profile in one go
  using Rows = Eigen::Matrix<double, kRows, 3>;
  using Column = Eigen::Matrix<double, kRows, 1>;
  ProfileFactor r = parts.front();
  for (size_t next = 1; next < parts.size();) {
    Rows stacked = Rows::Zero();
    stacked.topRows<3>() = r;
    for (Eigen::Index row = 3; row < kRows && next < parts.size(); row += 3) stacked.middleRows<3>(row) = parts[next++];
    r = Triangle<Column>(stacked.col(0), stacked.col(1), stacked.col(2));
  }
  return r;
}

std::array<PseudoPoint, 3> PseudoPoints(const ProfileFactor& factor) {
  CHECK_GT(factor(0, 0), 0) << "a profile without points has no pseudo-points";
  const Eigen::Matrix3d r = factor / factor(0, 0);
  std::array<PseudoPoint, 3> points{};
  for (int k = -1; k <= 1; ++k) {
    const double along = std::sqrt(1.5) * k, across = k == 0 ? -std::sqrt(2.0) : std::sqrt(0.5);
    points[k + 1] = {factor(0, 0) / std::sqrt(3.0), r(0, 2) + along * r(1, 2) + across * r(2, 2),
                     r(0, 1) + along * r(1, 1)};
  }
  return points;
}

std::array<PseudoPoint, 2> Ends(const ProfileFactor& factor) {
  CHECK_GT(factor(0, 0), 0) << "a profile without points has no ends";
  const Eigen::Matrix3d line = factor / factor(0, 0);  // of (1, z, y): means, then spreads
  const double y = std::numbers::sqrt3 * line(1, 2), z = std::numbers::sqrt3 * line(1, 1);
  return {{{1, line(0, 2) - y, line(0, 1) - z}, {1, line(0, 2) + y, line(0, 1) + z}}};
}

}  // namespace scancal
