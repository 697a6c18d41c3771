// One profile, compressed, and what errors do to it.
#include <glog/logging.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include "models/line/robust_line.h"
#include "models/turntable/compress.h"
#include "solver/dense.h"

namespace scancal::turntable {
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

// The rows (y, z, 1) w of a lidar with the column of ones last, see Model: its last diagonal is what no line
// explains in units of the range.
Eigen::Matrix3d OnesLast(const ProfileFactor& ranged) {
  const Eigen::Matrix3d columns = ranged(Eigen::all, std::vector{2, 1, 0});
  return Triangle<Eigen::Vector3d>(columns.col(0), columns.col(1), columns.col(2));
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

// What of errors that run along a profile moves its line, without their share in what no line explains: that is noise,
// and large. A profiler's line explains all that is affine in z; a lidar's what is linear in (y, z).
Eigen::MatrixXd WithoutPureError(const Model::View& view, const Eigen::MatrixXd& columns) {
  if (!view.along_range) return columns;
  Eigen::MatrixXd explained(std::ssize(view.points), 2);
  for (Eigen::Index i = 0; i < explained.rows(); ++i)
    explained.row(i) = view.points[i].weight * Eigen::RowVector2d(view.points[i].y, view.points[i].z);
  return explained * LeastSquares(explained, columns);
}

constexpr double kNoExtent_mm = 1e-9;

// Coordinates in the plate: across (at right angles to the axis of the table) and up.
struct PlateFrame {
  explicit PlateFrame(const Eigen::Vector3d& normal) {
    const Eigen::Vector3d sideways = normal.cross(Eigen::Vector3d::UnitZ());
    across = sideways.norm() > 1e-6 ? Eigen::Vector3d(sideways.normalized()) : Eigen::Vector3d(normal.unitOrthogonal());
    up = across.cross(normal);
  }
  Eigen::Vector2d At(const Eigen::Vector3d& p) const { return {across.dot(p), up.dot(p)}; }
  Eigen::Vector3d across, up;
};

// Where the profile bends, its segments show it.
std::vector<PseudoPoint> PointsOf(const Profile& profile) {
  std::vector<PseudoPoint> all;
  for (const ProfileFactor& segment : profile.segments) {
    const auto points = PseudoPoints(segment);
    all.insert(all.end(), points.begin(), points.end());
  }
  return all;
}

// Smallest and largest of every coordinate.
class Bounds {
 public:
  void Add(const Eigen::Array2d& at) {
    lowest_ = lowest_.min(at);
    highest_ = highest_.max(at);
  }
  Eigen::Array2d Scaled(const Eigen::Array2d& at) const {  // to [-1, 1]
    return (2 * at - lowest_ - highest_) / Sides();
  }
  double Aspect() const { return Sides()[0] / Sides()[1]; }
  Eigen::Array2d Sides() const { return (highest_ - lowest_).max(kNoExtent_mm); }

 private:
  Eigen::Array2d lowest_ = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity()), highest_ = -lowest_;
};

// weight * (a + b z) at the points of the view, the least squares line through `values` at the points of the profile.
template <class ValuesAt>
Eigen::MatrixXd AsLine(const Profile& profile, const Model::View& view, Eigen::Index columns,
                       const ValuesAt& values_at) {
  const std::vector<PseudoPoint> points = PointsOf(profile);
  const double count = profile.factor(0, 0) * profile.factor(0, 0),
               middle = profile.factor(0, 1) / profile.factor(0, 0);
  Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(columns), slope = mean;
  double squares = 0;
  for (const PseudoPoint& p : points) {
    const double weight = p.weight * p.weight, z = p.z - middle;
    const Eigen::RowVectorXd value = weight * values_at(p);
    mean += value / count;
    slope += z * value;
    squares += weight * z * z;
  }
  const bool level = squares <= count * kNoExtent_mm * kNoExtent_mm;  // no slope, and none is asked for
  if (!level) slope /= squares;
  Eigen::MatrixXd rows(std::ssize(view.points), columns);
  for (Eigen::Index i = 0; i < rows.rows(); ++i)
    rows.row(i) = view.points[i].weight * (level ? mean : mean + (view.points[i].z - middle) * slope);
  return WithoutPureError(view, rows);
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

std::vector<Model::View> Views(const std::vector<Profile>& profiles, Model::Residuals residuals) {
  std::vector<Model::View> views;
  for (const Profile& profile : profiles) {
    const bool along_range = residuals == Model::Residuals::kDepth && profile.ranged;
    const auto points = PseudoPoints(along_range ? *profile.ranged : profile.factor);
    Model::View& view = views.emplace_back();
    view = {profile.alpha, {points.begin(), points.end()}, profile.count, along_range};
    Eigen::MatrixXd line(3, 2);
    for (int i = 0; i < 3; ++i)
      line.row(i) = std::sqrt(profile.count / 3) * Eigen::RowVector2d(1, points[i].z - points[1].z);
    view.line = WithoutPureError(view, line);
  }
  return views;
}

Eigen::Array2d AddForm(const std::vector<Profile>& profiles, const System& system, const Eigen::Vector3d& normal,
                       double distance, std::vector<Model::View>* views) {
  const PlateFrame frame(normal);
  std::vector<ProfileInTable<double>> in_table;
  for (const Profile& profile : profiles) in_table.push_back(system.At(profile.alpha));
  // Where the line of sight meets the plane: at the measured point itself, its noise would be a form.
  const auto on_plate = [&](size_t k, const PseudoPoint& p) -> Eigen::Array2d {
    const ProfileInTable<double>& at = in_table[k];
    const Eigen::Vector3d measured = at.Point(p.y, p.z, system.Bend(p.y, p.z));
    const Eigen::Vector3d sight =
        profiles[k].ranged ? Eigen::Vector3d(measured - at.Turned(at.origin)) : at.Turned(at.along_y);
    return frame.At(measured - (normal.dot(measured) - distance) / normal.dot(sight) * sight).array();
  };
  Bounds plate;
  for (size_t k = 0; k < profiles.size(); ++k)
    for (const ProfileFactor& segment : profiles[k].segments)
      for (const PseudoPoint& p : Ends(segment)) plate.Add(on_plate(k, p));
  for (size_t k = 0; k < profiles.size(); ++k) {
    Model::View& view = (*views)[k];
    view.form = AsLine(profiles[k], view, kFormModes, [&](const PseudoPoint& p) -> Eigen::RowVectorXd {
      const Eigen::Array2d at = plate.Scaled(on_plate(k, p));
      return Eigen::Map<const Eigen::RowVectorXd>(FormModesAt(at[0], at[1], plate.Aspect()).data(), kFormModes);
    });
  }
  return plate.Sides();
}

void AddBend(const System& system, const std::vector<Profile>& profiles, std::vector<Model::View>* views) {
  for (size_t k = 0; k < profiles.size(); ++k) {
    Model::View& view = (*views)[k];
    view.bend = AsLine(profiles[k], view, std::ssize(Model::kBends), [&](const PseudoPoint& p) -> Eigen::RowVectorXd {
      return Eigen::Map<const Eigen::RowVectorXd>(system.Shapes(p.y, p.z).data(), std::ssize(Model::kBends));
    });
  }
}

std::vector<Model::View> PlaneViews(const std::vector<Profile>& profiles, const System& system) {
  std::vector<Model::View> views = Views(profiles, Model::Residuals::kPlane);
  if (system.Bends()) AddBend(system, profiles, &views);
  return views;
}

Eigen::Vector3d PointOf(const System& system, const ProfileInTable<double>& in_table, const Model::View& profile,
                        Eigen::Index point) {
  const PseudoPoint& p = profile.points[point];
  double bend = 0;
  for (size_t k = 0; k < Model::kBends.size() && profile.bend.size(); ++k)
    bend += system[Model::kBends[k]] * profile.bend(point, static_cast<Eigen::Index>(k)) / p.weight;
  return in_table.Point(p.y, p.z, bend);
}

}  // namespace scancal::turntable
