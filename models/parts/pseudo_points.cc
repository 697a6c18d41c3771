#include "models/parts/pseudo_points.h"
#include <glog/logging.h>
#include <Eigen/QR>
#include <cmath>

namespace scancal {
namespace {

// The triangle of the rows, its diagonal not negative.
template <class Rows>
ProfileFactor Triangle(const Rows& rows) {
  const Eigen::HouseholderQR<Rows> qr(rows);
  ProfileFactor r = qr.matrixQR().template topRows<3>().template triangularView<Eigen::Upper>();
  for (int k = 0; k < 3; ++k)
    if (r(k, k) < 0) r.row(k) = -r.row(k);
  return r;
}

}  // namespace

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
  Eigen::Matrix<double, Eigen::Dynamic, 3> rows = Eigen::MatrixXd::Zero(std::max<Eigen::Index>(n, 3), 3);
  for (Eigen::Index i = 0; i < n; ++i) rows.row(i) << weights[i], weights[i] * z[i], weights[i] * y[i];
  return Triangle(rows);
}

ProfileFactor Merged(std::span<const ProfileFactor> parts) {
  CHECK(!parts.empty());
  ProfileFactor r = parts.front();
  for (const ProfileFactor& part : parts.subspan(1))
    r = Triangle((Eigen::Matrix<double, 6, 3>() << r, part).finished());
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

}  // namespace scancal
