#include "models/robot_ball/tables.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include "io/message.h"
#include "models/chain/declare.h"
#include "models/median.h"
#include "solver/dense.h"

namespace scancal::robot_ball {
namespace {

constexpr Message<std::string_view, size_t, std::string_view> kEmptyPoses{
    "robot_ball.empty_poses", "{}: no ball was seen from {} of its poses, which are left out: {}",
    "{}: Aus {} der Posen wurde keine Kugel gesehen, sie sind weggelassen: {}"};

std::vector<TableColumn> Centre(bool required, const std::string& remedy = "") {
  std::vector<TableColumn> columns;
  for (const char* axis : {"x", "y", "z"})
    columns.push_back({axis, Cells::kNumber, Dimension::kLength, required, remedy});
  return columns;
}

void Append(const std::vector<TableColumn>& more, std::vector<TableColumn>* columns) {
  columns->insert(columns->end(), more.begin(), more.end());
}

Eigen::Vector3d CentreAt(const Table& table, size_t row) {
  return {table.Number("x", row), table.Number("y", row), table.Number("z", row)};
}

// As the table says, or by the number of its line.
std::vector<std::string> PoseNames(const Table& table) {
  if (table.Has("pose")) return table.Texts("pose");
  std::vector<std::string> names;
  for (size_t row = 1; row <= table.rows(); ++row) names.push_back(std::to_string(row));
  return names;
}

Result<std::vector<Eigen::Isometry3d>> FramesOf(const Table& table, const Orientation& orientation) {
  SCANCAL_ASSIGN_OR_RETURN(const std::vector<Eigen::Matrix3d> turns, orientation.Read(table));
  std::vector<Eigen::Isometry3d> frames;
  for (size_t row = 0; row < table.rows(); ++row) {
    Eigen::Isometry3d& frame = frames.emplace_back(Eigen::Isometry3d::Identity());
    frame.linear() = turns[row];
    frame.translation() = CentreAt(table, row);
  }
  return frames;
}

// The column u of a line, mm; 0: it says nothing.
Result<double> NoiseAt(const Table& table, size_t row) {
  const double u = table.Has("u") ? table.Number("u", row) : std::numeric_limits<double>::quiet_NaN();
  if (u <= 0) return table.Wrong(row, "u", "expected a standard uncertainty above 0, or nothing");
  return std::isnan(u) ? 0 : u;
}

Result<Table> ReadBallTable(const ScanFormat& format) {
  SCANCAL_ASSIGN_OR_RETURN(Table table, Table::Read(format, ObservationColumns()));
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
  const SymmetricEigen eigen = EigenOf(covariance);
  return eigen.vectors * eigen.values.cwiseSqrt().asDiagonal() * eigen.vectors.transpose();
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

std::vector<TableColumn> ArtifactColumns() {
  std::vector<TableColumn> columns = {{"ball"}};
  Append(Centre(true), &columns);
  columns.push_back({"u", Cells::kNumberOrNothing, Dimension::kLength, false});
  return columns;
}

Result<Artifact> ReadArtifact(const TableDeclaration& declared) {
  SCANCAL_ASSIGN_OR_RETURN(Table table, Table::Read(declared.format, ArtifactColumns()));
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
    const Eigen::Vector3d centre = CentreAt(table, row);
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

std::vector<TableColumn> PoseColumns(size_t joints, bool with_stations) {
  std::vector<TableColumn> columns = {{"pose", Cells::kText, Dimension::kNone, false}};
  if (with_stations) columns.push_back({"station"});
  columns.push_back({"temperature", Cells::kNumber, Dimension::kNone, false});
  if (joints == 0) {
    Append(Centre(true, "; joint angles need robot: links in dataset.yaml"), &columns);
    return columns;
  }
  Append(JointColumns(joints, fmt::format("; robot: links declares {} joints, without it the poses are those of the "
                                          "flange",
                                          joints)),
         &columns);
  return columns;
}

Result<Poses> ReadPoses(const TableDeclaration& declared, const std::vector<Link>& links,
                        const std::vector<Coupling>& couplings, bool with_stations) {
  std::vector<TableColumn> columns = PoseColumns(links.size(), with_stations);
  if (links.empty())
    Append(declared.orientation.Columns(
               true, "; joint angles need robot: links in dataset.yaml; how turns are written is declared as " +
                         OrientationRemedy()),
           &columns);
  SCANCAL_ASSIGN_OR_RETURN(Table table, Table::Read(declared.format, columns));
  std::vector<Eigen::Isometry3d> flanges;
  if (!links.empty()) {
    SCANCAL_RETURN_IF_ERROR(CheckJoints(table, links.size()));
  } else {
    SCANCAL_ASSIGN_OR_RETURN(flanges, FramesOf(table, declared.orientation));
  }
  Poses poses;
  const std::vector<std::string> names = PoseNames(table);
  std::unordered_map<std::string, size_t> stations;
  for (size_t row = 0; row < table.rows(); ++row) {
    const std::string& name = names[row];
    Model::View view;
    view.name = name;
    view.joints = JointsOf(table, row, links.size(), couplings);
    view.number = static_cast<int>(row);
    if (table.Has("temperature")) view.warmer = table.Number("temperature", row);
    if (links.empty()) view.base_from_flange = flanges[row];
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

std::vector<TableColumn> ObservationColumns() {
  std::vector<TableColumn> columns = {{"pose"}, {"ball"}};
  Append(Centre(false), &columns);
  columns.push_back({"u", Cells::kNumberOrNothing, Dimension::kLength, false});
  columns.push_back({"file", Cells::kText, Dimension::kNone, false});
  return columns;
}

Result<Observations> ReadObservations(const TableDeclaration& declared, const std::filesystem::path& folder,
                                      double ball_diameter) {
  Observations result;
  SCANCAL_ASSIGN_OR_RETURN(result.table, ReadBallTable(declared.format));
  const Table& table = result.table;
  result.poses = PoseNames(table);
  result.fitted = table.Has("file");
  result.seen.reserve(table.rows());
  for (size_t row = 0; row < table.rows(); ++row) {
    SeenCentre& seen = result.seen.emplace_back();
    if (result.fitted) continue;
    seen.centre = CentreAt(table, row);
    SCANCAL_ASSIGN_OR_RETURN(const double u, NoiseAt(table, row));
    seen.covariance = u * u * Eigen::Matrix3d::Identity();
  }
  if (result.fitted) SCANCAL_RETURN_IF_ERROR(FitBalls(folder, declared.format, ball_diameter, &result));
  return result;
}

std::vector<Model::Sphere> SpheresOfTarget() {
  constexpr double kArm_mm = 100;
  return {{"origin", Eigen::Vector3d::Zero()},
          {"x", kArm_mm * Eigen::Vector3d::UnitX()},
          {"y", kArm_mm * Eigen::Vector3d::UnitY()}};
}

bool IsTarget(const std::vector<Model::Sphere>& spheres) {
  const std::vector<Model::Sphere> target = SpheresOfTarget();
  return std::equal(spheres.begin(), spheres.end(), target.begin(), target.end(),
                    [](const auto& a, const auto& b) { return a.name == b.name && a.centre == b.centre; });
}

std::vector<TableColumn> TrackedColumns() {
  std::vector<TableColumn> columns = {{"pose", Cells::kText, Dimension::kNone, false},
                                      {"point", Cells::kText, Dimension::kNone, false}};
  Append(Centre(true), &columns);
  columns.push_back({"u", Cells::kNumberOrNothing, Dimension::kLength, false});
  return columns;
}

Result<Observations> ReadTracked(const TableDeclaration& declared) {
  Observations result;
  result.ball_column = "point";
  std::vector<TableColumn> columns = TrackedColumns();
  Append(declared.orientation.Columns(declared.names_orientation, ""), &columns);
  SCANCAL_ASSIGN_OR_RETURN(result.table, Table::Read(declared.format, columns));
  const Table& table = result.table;
  const bool turns = declared.orientation.IsIn(table);
  if (turns == table.Has("point"))
    return Error{table.name() +
                 ": expected the column point of reflectors, or those of the turn of a 6-DoF target, qx, qy, qz, qw or "
                 "as " +
                 OrientationRemedy() + ": " + (turns ? "not both" : "found neither")};
  result.poses = PoseNames(table);
  if (turns) {
    SCANCAL_ASSIGN_OR_RETURN(const auto targets, FramesOf(table, declared.orientation));
    for (size_t row = 0; row < table.rows(); ++row)
      for (const Model::Sphere& sphere : SpheresOfTarget()) {
        result.seen.push_back({targets[row] * sphere.centre, Eigen::Matrix3d::Zero()});
        result.rows.push_back(row);
        result.balls.push_back(sphere.name);
      }
    return result;
  }
  for (size_t row = 0; row < table.rows(); ++row) {
    SCANCAL_ASSIGN_OR_RETURN(const double u, NoiseAt(table, row));
    result.seen.push_back({CentreAt(table, row), u * u * Eigen::Matrix3d::Identity()});
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
      const Eigen::Isometry3d onto = MotionOnto(seen, known);
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
  if (const Table& table = observations.table; !table.Has("pose")) {
    if (poses->table.Has("pose"))
      return Error{table.name() + ": found no column 'pose', expected one with the names that " + poses->table.name() +
                   " has"};
    if (table.rows() != poses->table.rows())
      return Error{
          fmt::format("{}: found {} lines, but {} in {}: expected one for each of its poses, or a column "
                      "'pose' in both",
                      table.name(), table.rows(), poses->table.rows(), poses->table.name())};
  }
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
