// Centres of balls from points on them.
#include <fmt/format.h>
#include <cmath>
#include "io/scan.h"
#include "models/robot_ball/tables.h"
#include "models/sphere.h"
#include "solver/dense.h"

namespace scancal::robot_ball {
namespace {

constexpr Message<std::string_view, size_t, size_t, double> kPointsSetAside{
    "robot_ball.points_set_aside",
    "{}: {} of {} points on balls were set aside, farther than {} standard deviations from the sphere",
    "{}: {} von {} Punkten auf Kugeln wurden ausgesondert, weiter als {} Standardabweichungen von der Kugel entfernt"};

using Points = std::vector<Eigen::Vector3d>;

// table: where the file is named; its text is written alike.
Result<Points> ReadPoints(const std::filesystem::path& path, const ScanFormat& table) {
  ScanFormat format;
  format.path = path;
  format.units = table.units;
  format.text = table.text;
  format.text.where.clear();
  for (const char* axis : {"x", "y", "z"}) {
    format.columns.push_back({axis, Dimension::kLength});
    format.npy_columns.emplace_back(axis);
  }
  SCANCAL_ASSIGN_OR_RETURN(const auto reader, ScanReader::Open(format));
  Points points;
  ScanBatch batch;
  for (;;) {
    SCANCAL_ASSIGN_OR_RETURN(const bool more, reader->Next(&batch));
    if (!more) return points;
    const auto x = static_cast<size_t>(batch.Find("x")), y = static_cast<size_t>(batch.Find("y")),
               z = static_cast<size_t>(batch.Find("z"));
    for (size_t i = 0; i < batch.size(); ++i)
      points.emplace_back(batch.columns[x][i], batch.columns[y][i], batch.columns[z][i]);
  }
}

// Standard deviation across the plane that fits best.
double Thickness(const Points& points) {
  Eigen::MatrixXd rows(std::ssize(points), 3);
  for (size_t i = 0; i < points.size(); ++i) rows.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
  rows.rowwise() -= rows.colwise().mean().eval();
  return SvdOf(rows).values[2] / std::sqrt(static_cast<double>(points.size()));
}

// Why the sphere is not the ball; empty: nothing found.
std::string Doubt(const Points& points, const RobustSphere& sphere, double ball_diameter) {
  constexpr double kFlat = 3;  // the cap is no higher than its noise
  constexpr double kSameRadius = 0.05;
  const SphereFit free = FitRobustSphere(points).fit;
  if (ball_diameter > 0 && free.doubt.empty()) {
    const double off = 2 * free.radius / ball_diameter - 1, u = 2 * std::sqrt(free.covariance(3, 3)) / ball_diameter;
    if (std::abs(off) > kSameRadius + 5 * u)
      return fmt::format(
          "the points lie on a sphere of diameter {:.5g} mm, expected ball_diameter, {:.5g} mm; are both "
          "in the declared unit?",
          2 * free.radius, ball_diameter);
  }
  if (!sphere.fit.doubt.empty()) return sphere.fit.doubt;
  Points on;
  for (size_t i = 0; i < points.size(); ++i)
    if (!sphere.off[i]) on.push_back(points[i]);
  if (Thickness(on) <= kFlat * sphere.fit.sigma)
    return "the points lie on a plane within their noise, which leaves the side of the centre open; one laser line "
           "sees "
           "only a circle, expected points on a cap";
  if (2 * sphere.set_aside > std::ssize(points))
    return fmt::format("{} of {} points do not lie on the sphere, expected less than half", sphere.set_aside,
                       points.size());
  return "";
}

}  // namespace

Result<void> FitBalls(const std::filesystem::path& folder, const ScanFormat& declared, double ball_diameter,
                      Observations* observations) {
  const Table& table = observations->table;
  SphereChoice choice;
  if (ball_diameter > 0) choice.radius = KnownRadius{ball_diameter / 2, 0};
  size_t points_read = 0, set_aside = 0;
  for (size_t row = 0; row < table.rows(); ++row) {
    const std::filesystem::path path = folder / table.Text("file", row);
    SCANCAL_ASSIGN_OR_RETURN(const Points points, ReadPoints(path, declared));
    const RobustSphere sphere = FitRobustSphere(points, choice);
    if (const std::string doubt = Doubt(points, sphere, ball_diameter); !doubt.empty())
      return table.Wrong(row, "file", path.string() + ": " + doubt);
    observations->seen[row].centre = sphere.fit.centre;
    observations->seen[row].covariance = sphere.fit.covariance.topLeftCorner<3, 3>();
    observations->files.push_back(path);
    points_read += points.size();
    set_aside += static_cast<size_t>(sphere.set_aside);
  }
  if (set_aside > 0)
    observations->warnings.push_back(Say(kPointsSetAside, table.name(), set_aside, points_read, kOffSphere));
  return {};
}

}  // namespace scancal::robot_ball
