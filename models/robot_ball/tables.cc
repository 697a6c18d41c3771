#include "models/robot_ball/tables.h"
#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include "io/message.h"
#include "io/scan.h"
#include "models/chain/declare.h"
#include "models/median.h"
#include "models/sphere.h"
#include "solver/dense.h"

namespace scancal::robot_ball {
namespace {

constexpr Message<std::string_view, size_t, size_t, double> kPointsSetAside{
    "robot_ball.points_set_aside",
    "{}: {} of {} points on balls were set aside, farther than {} standard deviations from the sphere",
    "{}: {} von {} Punkten auf Kugeln wurden ausgesondert, weiter als {} Standardabweichungen von der Kugel entfernt"};
constexpr Message<std::string_view, size_t, std::string_view> kEmptyPoses{
    "robot_ball.empty_poses", "{}: no ball was seen from {} of its poses, which are left out: {}",
    "{}: Aus {} der Posen wurde keine Kugel gesehen, sie sind weggelassen: {}"};

constexpr double kNormTolerance = 1e-3;  // a quaternion written with four digits
const std::vector<std::string> kQuaternion = {"qx", "qy", "qz", "qw"};

std::vector<TableColumn> PoseColumns(size_t joints, bool with_stations) {
  std::vector<TableColumn> columns = {{"pose"}};
  if (with_stations) columns.push_back({"station"});
  if (joints > 0) {
    const std::string remedy =
        fmt::format("; robot: links declares {} joints, without it the poses are those of the flange", joints);
    for (const TableColumn& column : JointColumns(joints, remedy)) columns.push_back(column);
    return columns;
  }
  const char* remedy = "; joint angles need robot: links in dataset.yaml";
  for (const char* axis : {"x", "y", "z"}) columns.push_back({axis, Cells::kNumber, Dimension::kLength, true, remedy});
  for (const std::string& part : kQuaternion) columns.push_back({part, Cells::kNumber, Dimension::kNone, true, remedy});
  return columns;
}

Result<Eigen::Isometry3d> FlangeOf(const Table& table, size_t row) {
  const auto at = [&](const char* column) { return table.Number(column, row); };
  const Eigen::Quaterniond turn(at("qw"), at("qx"), at("qy"), at("qz"));
  if (!(std::abs(turn.norm() - 1) <= kNormTolerance))
    return table.Wrong(row, "qx",
                       fmt::format("the quaternion qx, qy, qz, qw has length {:.6g}, expected 1", turn.norm()));
  Eigen::Isometry3d flange = Eigen::Isometry3d::Identity();
  flange.linear() = turn.normalized().toRotationMatrix();
  flange.translation() << at("x"), at("y"), at("z");
  return flange;
}

using Points = std::vector<Eigen::Vector3d>;

Result<Points> ReadPoints(const std::filesystem::path& path, const Units& units) {
  ScanFormat format;
  format.path = path;
  format.units = units;
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

// Reads the file of every row and sets centre and covariance. Refused: a sphere that the points do not determine, a
// declared diameter that they contradict, points of one laser line (a circle, which leaves the centre two-fold).
Result<void> FitBalls(const std::filesystem::path& folder, const Units& units, double ball_diameter,
                      Observations* observations) {
  const Table& table = observations->table;
  SphereChoice choice;
  if (ball_diameter > 0) choice.radius = KnownRadius{ball_diameter / 2, 0};
  size_t points_read = 0, set_aside = 0;
  for (size_t row = 0; row < table.rows(); ++row) {
    const std::filesystem::path path = folder / table.Text("file", row);
    SCANCAL_ASSIGN_OR_RETURN(const Points points, ReadPoints(path, units));
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

Result<Table> ReadBallTable(const std::filesystem::path& path, const Units& units) {
  using enum Dimension;
  SCANCAL_ASSIGN_OR_RETURN(Table table, Table::Read(path,
                                                    {{"pose"},
                                                     {"ball"},
                                                     {"x", Cells::kNumber, kLength, false},
                                                     {"y", Cells::kNumber, kLength, false},
                                                     {"z", Cells::kNumber, kLength, false},
                                                     {"u", Cells::kNumberOrNothing, kLength, false},
                                                     {"file", Cells::kText, kNone, false}},
                                                    units));
  const bool centres = table.Has("x") && table.Has("y") && table.Has("z");
  if (centres == table.Has("file"))
    return Error{table.name() +
                 ": expected the columns x, y, z of the balls' centres, or file of the points on them, " +
                 (centres ? "not both" : "found neither")};
  return table;
}

constexpr double kRounding_mm = 1e-9;  // of centres fitted to exact points

double SizeOf(const Eigen::Matrix3d& covariance) { return std::sqrt(covariance.trace() / 3); }

double MedianSize(const Observations& observations) {
  std::vector<double> sizes;
  for (const SeenCentre& seen : observations.seen)
    if (const double size = SizeOf(seen.covariance); size > 0) sizes.push_back(size);
  const double median = Median(std::move(sizes));
  return median > kRounding_mm ? median : 0;
}

Eigen::Matrix3d SquareRoot(const Eigen::Matrix3d& covariance) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).operatorSqrt();
}

std::vector<std::string> NamesOf(const Poses& poses) {
  std::vector<std::string> names;
  for (const Station& station : poses.stations)
    for (const Model::View& view : station.views) names.push_back(view.name);
  return names;
}

Error SeenTwice(const Observations& observations, size_t row) {
  size_t first = 0;
  while (observations.Pose(first) != observations.Pose(row) || observations.Ball(first) != observations.Ball(row))
    ++first;
  return observations.table.Wrong(
      observations.Row(row), observations.balls.empty() ? observations.ball_column : "pose",
      fmt::format("found {} again in pose {} (it stands also at {}), expected each ball once; name one of them as the "
                  "ball that it is, or remove it",
                  Quoted(observations.Ball(row)), Quoted(observations.Pose(row)),
                  observations.table.Place(observations.Row(first))));
}

}  // namespace

Result<Artifact> ReadArtifact(const std::filesystem::path& path, const Units& units) {
  using enum Dimension;
  SCANCAL_ASSIGN_OR_RETURN(Table table, Table::Read(path,
                                                    {{"ball"},
                                                     {"x", Cells::kNumber, kLength},
                                                     {"y", Cells::kNumber, kLength},
                                                     {"z", Cells::kNumber, kLength},
                                                     {"u", Cells::kNumberOrNothing, kLength, false}},
                                                    units));
  Artifact artifact;
  std::unordered_map<std::string, size_t> rows;
  for (size_t row = 0; row < table.rows(); ++row) {
    const std::string& name = table.Text("ball", row);
    const auto [first, is_new] = rows.try_emplace(name, row);
    if (!is_new)
      return table.Wrong(row, "ball",
                         "found " + Quoted(name) +
                             " again, expected a name that no other ball has (it stands also at " +
                             table.Place(first->second) + ")");
    const Eigen::Vector3d centre(table.Number("x", row), table.Number("y", row), table.Number("z", row));
    for (const Model::Sphere& other : artifact.spheres)
      if (centre == other.centre)
        return table.Wrong(row, "x", "ball " + Quoted(name) + " lies where " + Quoted(other.name) + " does");
    artifact.spheres.push_back({name, centre});
    artifact.u.push_back(table.Has("u") ? table.Number("u", row) : std::numeric_limits<double>::quiet_NaN());
    if (artifact.u.back() < 0) return table.Wrong(row, "u", "expected a standard uncertainty, not negative");
  }
  artifact.table = std::move(table);
  return artifact;
}

Result<Poses> ReadPoses(const std::filesystem::path& path, const std::vector<Link>& links, const Units& units,
                        bool with_stations) {
  SCANCAL_ASSIGN_OR_RETURN(Table table, Table::Read(path, PoseColumns(links.size(), with_stations), units));
  if (!links.empty()) SCANCAL_RETURN_IF_ERROR(CheckJoints(table, links.size()));
  Poses poses;
  std::unordered_map<std::string, size_t> stations;
  for (size_t row = 0; row < table.rows(); ++row) {
    const std::string& name = table.Text("pose", row);
    Model::View view;
    view.name = name;
    view.joints = JointsOf(table, row, links.size());
    view.number = static_cast<int>(row);
    if (links.empty()) {
      SCANCAL_ASSIGN_OR_RETURN(view.base_from_flange, FlangeOf(table, row));
    }
    const std::string of_station = with_stations ? table.Text("station", row) : "world";
    const size_t station = stations.try_emplace(of_station, stations.size()).first->second;
    if (station == poses.stations.size()) poses.stations.push_back({of_station, {}});
    std::vector<Model::View>& views = poses.stations[station].views;
    const auto [place, is_new] = poses.places.try_emplace(name, Poses::Place{station, views.size(), row});
    if (!is_new)
      return table.Wrong(
          row, "pose",
          fmt::format("found \"{}\" again, expected a name that no other pose of the file has (it stands "
                      "also at {})",
                      name, table.Place(place->second.row)));
    views.push_back(std::move(view));
  }
  poses.table = std::move(table);
  return poses;
}

Result<Observations> ReadObservations(const std::filesystem::path& path, const std::filesystem::path& folder,
                                      const Units& units, double ball_diameter) {
  Observations result;
  SCANCAL_ASSIGN_OR_RETURN(result.table, ReadBallTable(path, units));
  const Table& table = result.table;
  result.fitted = table.Has("file");
  result.seen.reserve(table.rows());
  for (size_t row = 0; row < table.rows(); ++row) {
    SeenCentre& seen = result.seen.emplace_back();
    if (result.fitted) continue;
    seen.centre << table.Number("x", row), table.Number("y", row), table.Number("z", row);
    if (!table.Has("u")) continue;
    const double u = table.Number("u", row);
    if (u <= 0) return table.Wrong(row, "u", "expected a standard uncertainty above 0, or nothing");
    if (u > 0) seen.covariance = u * u * Eigen::Matrix3d::Identity();  // not of nan
  }
  if (result.fitted) SCANCAL_RETURN_IF_ERROR(FitBalls(folder, units, ball_diameter, &result));
  return result;
}

std::vector<Model::Sphere> SpheresOfTarget() {
  constexpr double kArm_mm = 100;
  return {{"origin", Eigen::Vector3d::Zero()},
          {"x", kArm_mm * Eigen::Vector3d::UnitX()},
          {"y", kArm_mm * Eigen::Vector3d::UnitY()}};
}

Result<Observations> ReadTracked(const std::filesystem::path& path, const Units& units) {
  using enum Dimension;
  Observations result;
  result.ball_column = "point";
  std::vector<TableColumn> columns = {{"pose"},
                                      {"point", Cells::kText, kNone, false},
                                      {"x", Cells::kNumber, kLength},
                                      {"y", Cells::kNumber, kLength},
                                      {"z", Cells::kNumber, kLength},
                                      {"u", Cells::kNumberOrNothing, kLength, false}};
  for (const std::string& part : kQuaternion) columns.push_back({part, Cells::kNumber, kNone, false});
  SCANCAL_ASSIGN_OR_RETURN(result.table, Table::Read(path, columns, units));
  const Table& table = result.table;
  const bool turns =
      std::all_of(kQuaternion.begin(), kQuaternion.end(), [&](const std::string& part) { return table.Has(part); });
  if (turns == table.Has("point"))
    return Error{table.name() +
                 ": expected the columns point, x, y, z of reflectors, or x, y, z, qx, qy, qz, qw of a "
                 "6-DoF target, " +
                 (turns ? "not both" : "found neither")};
  for (size_t row = 0; row < table.rows(); ++row) {
    if (turns) {
      SCANCAL_ASSIGN_OR_RETURN(const Eigen::Isometry3d target, FlangeOf(table, row));
      for (const Model::Sphere& sphere : SpheresOfTarget()) {
        result.seen.push_back({target * sphere.centre, Eigen::Matrix3d::Zero()});
        result.rows.push_back(row);
        result.balls.push_back(sphere.name);
      }
      continue;
    }
    SeenCentre& seen = result.seen.emplace_back();
    seen.centre << table.Number("x", row), table.Number("y", row), table.Number("z", row);
    if (!table.Has("u")) continue;
    const double u = table.Number("u", row);
    if (u <= 0) return table.Wrong(row, "u", "expected a standard uncertainty above 0, or nothing");
    if (u > 0) seen.covariance = u * u * Eigen::Matrix3d::Identity();  // not of nan
  }
  return result;
}

Result<Shape> ShapeOf(const std::vector<Station>& stations, const std::vector<std::string>& names) {
  constexpr int kRounds = 5;
  std::vector<const Model::View*> views;
  for (const Station& station : stations)
    for (const Model::View& view : station.views) views.push_back(&view);
  const auto most = std::max_element(views.begin(), views.end(),
                                     [](const auto* a, const auto* b) { return a->balls.size() < b->balls.size(); });
  const auto n = std::ssize(names);
  if (most == views.end() || std::ssize((*most)->balls) < n)
    return Error{fmt::format("no pose saw all {} points of the tool, which says where they are on it", n)};
  Eigen::Matrix3Xd shape(3, n);
  for (const Model::SeenBall& ball : (*most)->balls) shape.col(ball.sphere) = ball.centre;
  shape.colwise() -= Eigen::Vector3d(shape.col((*most)->balls.front().sphere));
  Eigen::VectorXd count = Eigen::VectorXd::Ones(n);
  double squares = 0, numbers = 0;
  for (int round = 0; round < kRounds && n > 2; ++round) {
    Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, n);
    count.setZero();
    squares = numbers = 0;
    for (const Model::View* view : views) {
      if (view->balls.size() < 3) continue;
      Eigen::Matrix3Xd seen(3, std::ssize(view->balls)), known = seen;
      for (size_t b = 0; b < view->balls.size(); ++b) {
        seen.col(static_cast<Eigen::Index>(b)) = view->balls[b].centre;
        known.col(static_cast<Eigen::Index>(b)) = shape.col(view->balls[b].sphere);
      }
      Eigen::Isometry3d onto = Eigen::Isometry3d::Identity();
      onto.matrix() = Eigen::umeyama(seen, known, false);
      for (size_t b = 0; b < view->balls.size(); ++b) {
        sum.col(view->balls[b].sphere) += onto * view->balls[b].centre;
        count[view->balls[b].sphere] += 1;
      }
      squares += (onto * seen - known).squaredNorm();
      numbers += 3 * static_cast<double>(view->balls.size()) - 6;
    }
    if (count.minCoeff() > 0) shape = sum * count.cwiseInverse().asDiagonal();
  }
  if (n == 2) {
    std::vector<double> apart;
    for (const Model::View* view : views)
      if (view->balls.size() == 2) apart.push_back((view->balls[0].centre - view->balls[1].centre).norm());
    shape.col(1) = shape.col(0) + Median(apart) * Eigen::Vector3d::UnitX();
  }
  shape.colwise() -= Eigen::Vector3d(shape.col(0));
  if (n > 2) {  // the frame is the tool's own, whatever pose came first
    const Eigen::Vector3d x = shape.col(1).normalized(), z = x.cross(shape.col(2)).normalized();
    shape = (Eigen::Matrix3d() << x, z.cross(x), z).finished().transpose() * shape;
  }
  Shape result;
  for (Eigen::Index k = 0; k < n; ++k) result.spheres.push_back({names[static_cast<size_t>(k)], shape.col(k)});
  if (numbers > 0 && n > 2) result.u = std::sqrt(squares / numbers / count.minCoeff());
  return result;
}

double UsualNoise(const Observations& observations, double declared) {
  return declared > 0 ? declared : MedianSize(observations);
}

Result<void> AttachBalls(const Observations& observations, const std::vector<std::string>& balls,
                         const std::string& where, double declared_noise, Poses* poses) {
  std::unordered_map<std::string, int> indices;
  for (const std::string& ball : balls) indices.try_emplace(ball, static_cast<int>(indices.size()));
  const double unit = observations.fitted ? MedianSize(observations) : UsualNoise(observations, declared_noise);
  for (size_t row = 0; row < observations.seen.size(); ++row) {
    const std::string &pose_name = observations.Pose(row), &ball_name = observations.Ball(row);
    const auto place = poses->places.find(pose_name);
    if (place == poses->places.end())
      return observations.table.Wrong(observations.Row(row), "pose",
                                      "found " + Quoted(pose_name) + ", which " + poses->table.name() +
                                          " does not have" + Suggestion(pose_name, NamesOf(*poses)));
    const auto ball = indices.find(ball_name);
    if (ball == indices.end())
      return observations.table.Wrong(
          observations.Row(row), observations.ball_column,
          "found " + Quoted(ball_name) + ", which " + where + " does not have" + Suggestion(ball_name, balls));
    std::vector<Model::SeenBall>& view = poses->View(place->second).balls;
    for (const Model::SeenBall& other : view)
      if (other.sphere == ball->second) return SeenTwice(observations, row);
    Model::SeenBall& added = view.emplace_back();
    added.sphere = ball->second;
    added.centre = observations.seen[row].centre;
    const Eigen::Matrix3d& covariance = observations.seen[row].covariance;
    if (unit > 0 && SizeOf(covariance) > 0) added.spread = SquareRoot(covariance) / unit;
  }
  return {};
}

std::vector<Station> TakeSeenStations(Poses* poses, std::vector<Sentence>* warnings) {
  std::vector<Station> stations;
  std::vector<std::string> empty;
  for (Station& station : poses->stations) {
    Station kept{station.name, {}};
    for (Model::View& view : station.views) {
      if (view.balls.empty()) empty.push_back(view.name);
      else kept.views.push_back(std::move(view));
    }
    if (!kept.views.empty()) stations.push_back(std::move(kept));
  }
  if (!empty.empty()) warnings->push_back(Say(kEmptyPoses, poses->table.name(), empty.size(), Listed(empty)));
  return stations;
}

}  // namespace scancal::robot_ball
