#include "models/turntable/profile.h"
#include <glog/logging.h>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include "models/parts/robust_line.h"
#include "models/turntable/raw_profiles.h"

namespace scancal {
namespace {

struct Line {  // the points with a + b z + c y = 0
  double a = 0, b = 0, c = 1;
  // In the direction of a point: free of the point's own noise. The point's range if the line is not near it.
  double RangeTowards(double y, double z) const {
    const double range = std::hypot(y, z), towards = (b * z + c * y) / range;
    const double on_line = towards != 0 ? -a / towards : range;
    return on_line > 0.5 * range && on_line < 2 * range ? on_line : range;
  }
};

std::vector<double> RangesOnLine(std::span<const double> y, std::span<const double> z) {
  const RobustLine robust = FitRobustLine(y, z);
  const Line line{robust.Distance(0, 0), -robust.dy, robust.dz};
  std::vector<double> ranges(y.size());
  for (size_t i = 0; i < y.size(); ++i) ranges[i] = line.RangeTowards(y[i], z[i]);
  return ranges;
}

// The rows (y, z, 1) w of a lidar with the column of ones last, see Turntable: its last diagonal is what no line
// explains in units of the range.
Eigen::Matrix3d OnesLast(const ProfileFactor& ranged) {
  const Eigen::Matrix3d columns = ranged(Eigen::all, std::vector{2, 1, 0});
  return Eigen::HouseholderQR<Eigen::Matrix3d>(columns).matrixQR().triangularView<Eigen::Upper>();
}

// Least squares of depth, or of the range. Of points at one height the level line.
Line LineOf(const Profile& profile) {
  if (profile.ranged) {
    const Eigen::Matrix3d r = OnesLast(*profile.ranged);
    if (r(0, 0) == 0 || r(1, 1) == 0) return {};
    const double z = -r(1, 2) / r(1, 1), y = -(r(0, 2) + r(0, 1) * z) / r(0, 0);
    return {1, z, y};
  }
  const ProfileFactor& r = profile.factor;
  const double slope = r(1, 1) > 0 ? r(1, 2) / r(1, 1) : 0;
  return {-(r(0, 2) - slope * r(0, 1)) / r(0, 0), -slope, 1};
}

Profile CompressInOrder(double alpha, std::span<const double> y, std::span<const double> z,
                        std::span<const double> range) {
  std::vector<ProfileFactor> segments;
  auto first = z.begin();
  for (int k = 1; k <= kSegments; ++k) {
    const double end = z.front() + k * (z.back() - z.front()) / kSegments;
    const auto last = k < kSegments ? std::lower_bound(first, z.end(), end) : z.end();
    const auto from = static_cast<size_t>(first - z.begin()), count = static_cast<size_t>(last - first);
    if (count > 0) segments.push_back(Factor(y.subspan(from, count), z.subspan(from, count)));
    first = last;
  }
  std::optional<ProfileFactor> ranged;
  if (!range.empty()) ranged = Factor(y, z, RangesOnLine(y, z));
  return MakeProfile(alpha, static_cast<double>(y.size()), std::move(segments), ranged);
}

}  // namespace

Profile MakeProfile(double alpha, double count, std::vector<ProfileFactor> segments,
                    const std::optional<ProfileFactor>& ranged) {
  Profile profile{alpha, count, std::move(segments), {}, ranged, {}};
  profile.factor = Merged(profile.segments);
  const double unexplained = ranged ? OnesLast(*ranged)(2, 2) : profile.factor(2, 2);
  profile.pure_error = {unexplained * unexplained, std::max(0.0, count - 2)};
  return profile;
}

Profile CompressProfile(double alpha, std::span<const double> y, std::span<const double> z,
                        std::span<const double> range) {
  CHECK(!y.empty());
  if (IsAscending(z.data(), z.size())) return CompressInOrder(alpha, y, z, range);
  RawProfile ordered{0, alpha, {y.begin(), y.end()}, {z.begin(), z.end()}, {range.begin(), range.end()}};
  OrderAlongLine(&ordered);
  return CompressInOrder(alpha, ordered.y, ordered.z, ordered.range);
}

std::vector<double> ResidualsFromLine(const Profile& profile, std::span<const double> y, std::span<const double> z) {
  const Line line = LineOf(profile);
  std::vector<double> residuals(y.size());
  for (size_t i = 0; i < y.size(); ++i)
    residuals[i] =
        profile.ranged ? std::hypot(y[i], z[i]) - line.RangeTowards(y[i], z[i]) : y[i] + (line.b * z[i] + line.a);
  return residuals;
}

std::vector<Turntable::View> Views(const std::vector<Profile>& profiles, Turntable::Residuals residuals) {
  std::vector<Turntable::View> views;
  for (const Profile& profile : profiles) {
    const bool along_range = residuals == Turntable::Residuals::kDepth && profile.ranged;
    const auto points = PseudoPoints(along_range ? *profile.ranged : profile.factor);
    Turntable::View& view = views.emplace_back();
    view = {profile.alpha, {points.begin(), points.end()}, profile.count, along_range};
    Eigen::MatrixXd line(3, 2);
    for (int i = 0; i < 3; ++i)
      line.row(i) = std::sqrt(profile.count / 3) * Eigen::RowVector2d(1, points[i].z - points[1].z);
    view.line = WithoutPureError(view, line);
  }
  return views;
}

Eigen::MatrixXd WithoutPureError(const Turntable::View& view, const Eigen::MatrixXd& columns) {
  if (!view.along_range) return columns;
  Eigen::MatrixXd explained(std::ssize(view.points), 2);
  for (Eigen::Index i = 0; i < explained.rows(); ++i)
    explained.row(i) = view.points[i].weight * Eigen::RowVector2d(view.points[i].y, view.points[i].z);
  return explained * Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(explained).solve(columns);
}

}  // namespace scancal
