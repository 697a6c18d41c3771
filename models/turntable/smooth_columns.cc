#include "models/turntable/smooth_columns.h"
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <cmath>
#include <limits>

namespace scancal {
namespace {

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

 private:
  Eigen::Array2d Sides() const { return (highest_ - lowest_).max(kNoExtent_mm); }
  Eigen::Array2d lowest_ = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity()), highest_ = -lowest_;
};

// weight * (a + b z) at the points of the view, the least squares line through `values` at the points of the profile.
template <class ValuesAt>
Eigen::MatrixXd AsLine(const Profile& profile, const Turntable::View& view, Eigen::Index columns,
                       const ValuesAt& values_at) {
  const std::vector<PseudoPoint> points = PointsOf(profile);
  Eigen::MatrixXd line(std::ssize(points), 2), values(std::ssize(points), columns), rows(std::ssize(view.points), 2);
  for (Eigen::Index i = 0; i < line.rows(); ++i) {
    line.row(i) = points[i].weight * Eigen::RowVector2d(1, points[i].z);
    values.row(i) = points[i].weight * values_at(points[i]);
  }
  for (Eigen::Index i = 0; i < rows.rows(); ++i)
    rows.row(i) = view.points[i].weight * Eigen::RowVector2d(1, view.points[i].z);
  return WithoutPureError(view, rows * Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(line).solve(values));
}

}  // namespace

void AddForm(const std::vector<Profile>& profiles, const turntable::System& system, const Eigen::Vector3d& normal,
             double distance, std::vector<Turntable::View>* views) {
  const PlateFrame frame(normal);
  std::vector<turntable::ProfileInTable<double>> in_table;
  for (const Profile& profile : profiles) in_table.push_back(system.At(profile.alpha));
  // Where the line of sight meets the plane: at the measured point itself, its noise would be a form.
  const auto on_plate = [&](size_t k, const PseudoPoint& p) -> Eigen::Array2d {
    const auto at = [&](double y, double z) {
      return Eigen::Vector3d(Eigen::Vector3d::Map(in_table[k].Point(y, z, system.Bend(y)).data()));
    };
    const Eigen::Vector3d measured = at(p.y, p.z);
    const Eigen::Vector3d sight = measured - at(0, profiles[k].ranged ? 0 : p.z);
    return frame.At(measured - (normal.dot(measured) - distance) / normal.dot(sight) * sight).array();
  };
  Bounds plate;
  for (size_t k = 0; k < profiles.size(); ++k)
    for (const ProfileFactor& segment : profiles[k].segments)
      for (const PseudoPoint& p : Ends(segment)) plate.Add(on_plate(k, p));
  for (size_t k = 0; k < profiles.size(); ++k) {
    Turntable::View& view = (*views)[k];
    view.form = AsLine(profiles[k], view, kFormModes, [&](const PseudoPoint& p) -> Eigen::RowVectorXd {
      const Eigen::Array2d at = plate.Scaled(on_plate(k, p));
      return Eigen::Map<const Eigen::RowVectorXd>(FormModesAt(at[0], at[1], plate.Aspect()).data(), kFormModes);
    });
  }
}

void AddBend(const turntable::System& system, const std::vector<Profile>& profiles,
             std::vector<Turntable::View>* views) {
  for (size_t k = 0; k < profiles.size(); ++k) {
    Turntable::View& view = (*views)[k];
    view.bend = AsLine(profiles[k], view, 1, [&](const PseudoPoint& p) -> Eigen::RowVectorXd {
      return Eigen::RowVectorXd::Constant(1, system.Bend(p.y));
    });
  }
}

std::vector<Turntable::View> PlaneViews(const std::vector<Profile>& profiles, const turntable::System& system) {
  std::vector<Turntable::View> views = Views(profiles, Turntable::Residuals::kPlane);
  if (system[Turntable::kLinearity] != 0) AddBend(system, profiles, &views);
  return views;
}

std::array<double, 3> PointOf(const turntable::ProfileInTable<double>& in_table, const Turntable::View& profile,
                              Eigen::Index point) {
  const PseudoPoint& p = profile.points[point];
  return in_table.Point(p.y, p.z, profile.bend.size() ? profile.bend[point] / p.weight : 0);
}

}  // namespace scancal
