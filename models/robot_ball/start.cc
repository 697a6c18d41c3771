#include "models/robot_ball/start.h"
#include <fmt/format.h>
#include <glog/logging.h>
#include <algorithm>
#include <cmath>
#include <string>
#include "solver/dense.h"

namespace scancal::robot_ball {
namespace {

using Eigen::Index, Eigen::Isometry3d, Eigen::Matrix3d, Eigen::MatrixXd, Eigen::Vector3d, Eigen::VectorXd;

// Columns of the linear model: R column by column, t, the factor of F's translation.
constexpr int kR = 0, kT = 9, kFactor = 12, kColumns = 13;
constexpr int kStationColumns = 12;  // N column by column, n
// Turns and movements below these are the robot's repeatability, not its motion.
constexpr double kSmallestTurn_rad = 1e-3, kSmallestMove_mm = 0.01;

int Balls(const Station& station) {
  int balls = 0;
  for (const Model::View& view : station.views) balls += static_cast<int>(view.balls.size());
  return balls;
}

int Balls(const std::vector<Station>& stations) {
  int balls = 0;
  for (const Station& station : stations) balls += Balls(station);
  return balls;
}

// A triangle T of no more rows than columns with |T x| = |rows x|.
MatrixXd Triangle(const MatrixXd& rows) {
  if (rows.rows() <= rows.cols()) return rows;
  return UpperTriangle(rows);
}

// The points that a pose saw, as they lie on the tool and in the world. Few reflectors of a tool lie in a plane, which
// would leave a column of R without effect: a point above the plane of the first three is as rigid as they are.
std::vector<std::pair<Vector3d, Vector3d>> PointsOf(const Measurements& data, const Model::View& view) {
  std::vector<std::pair<Vector3d, Vector3d>> points;
  for (const Model::SeenBall& ball : view.balls) points.emplace_back(data.OnTool(ball), data.InWorld(ball));
  if (!data.measured_in_world || points.size() < 3) return points;
  const auto above = [&](auto side) -> Vector3d {
    const Vector3d a = side(points[1]) - side(points[0]), b = side(points[2]) - side(points[0]);
    return side(points[0]) + a.cross(b) / std::sqrt(a.cross(b).norm());
  };
  points.emplace_back(above([](const auto& point) { return point.first; }),
                      above([](const auto& point) { return point.second; }));
  return points;
}

MatrixXd StationRows(const Measurements& data, const Station& station) {
  Index rows = 0;
  for (const Model::View& view : station.views) rows += 3 * std::ssize(PointsOf(data, view));
  MatrixXd common(rows, kColumns), own(rows, kStationColumns);
  Index row = 0;
  for (const Model::View& view : station.views) {
    const Isometry3d flange = BaseFromScanner(data, {}, view);
    for (const auto& [on_tool, in_world] : PointsOf(data, view)) {
      for (int l = 0; l < 3; ++l) {
        common.block<3, 3>(row, kR + 3 * l) = flange.linear() * on_tool[l];
        own.block<3, 3>(row, 3 * l) = Matrix3d::Identity() * in_world[l];
      }
      common.block<3, 3>(row, kT) = flange.linear();
      common.block<3, 1>(row, kFactor) = flange.translation();
      own.block<3, 3>(row, 9).setIdentity();
      row += 3;
    }
  }
  for (Index k = 0; k < own.cols(); ++k) own.col(k).normalize();  // of all zeros: stays, and is no column
  return Triangle(ProjectOut(own, common));
}

MatrixXd AllRows(const Measurements& data) {
  std::vector<MatrixXd> of_stations;
  Index rows = 0;
  for (const Station& station : data.stations) {
    of_stations.push_back(StationRows(data, station));
    rows += of_stations.back().rows();
  }
  MatrixXd all(rows, kColumns);
  rows = 0;
  for (const MatrixXd& each : of_stations) {
    all.middleRows(rows, each.rows()) = each;
    rows += each.rows();
  }
  return all;
}

Matrix3d NearestRotation(Matrix3d matrix) {
  if (matrix.determinant() < 0) matrix = -matrix;  // a singular vector has no sign
  return NearestOrthogonal(matrix);
}

std::string Names(const std::vector<Station>& stations) {
  constexpr size_t kNamed = 4;
  std::string names = stations.size() == 1 ? "station " : "stations ";
  for (size_t s = 0; s < std::min(stations.size(), kNamed); ++s) names += (s ? ", " : "") + stations[s].name;
  return stations.size() > kNamed ? fmt::format("{} and {} more", names, stations.size() - kNamed) : names;
}

Result<Matrix3d> Rotation(const std::vector<Station>& stations, const MatrixXd& rows) {
  MatrixXd shift = rows.middleCols<4>(kT);
  for (Index k = 0; k < shift.cols(); ++k) shift.col(k).normalize();
  MatrixXd left = ProjectOut(shift, rows.leftCols<9>());
  if (left.rows() < 8)
    return Error{
        fmt::format("{}: the balls give {} equations for the turn of the hand-eye, expected at least 8: see "
                    "the same balls from more poses",
                    Names(stations), left.rows())};
  if (left.rows() == 8) left = (MatrixXd(9, 9) << left, Eigen::RowVectorXd::Zero(9)).finished();  // of rank 8 at most
  const Svd svd = SvdOf(left);
  const VectorXd& sigma = svd.values;
  if (sigma[7] < kSmallestMove_mm * std::sqrt(Balls(stations)) || sigma[8] > 0.5 * sigma[7])
    return Error{fmt::format(
        "{}: the poses do not determine the turn of the hand-eye: they hardly turn or move the flange, or not about "
        "two axes or in three directions, or they contradict each other",
        Names(stations))};
  const VectorXd smallest = svd.v.col(8);
  return NearestRotation(Eigen::Map<const Matrix3d>(smallest.data()));
}

Result<Vector3d> Translation(const std::vector<Station>& stations, const MatrixXd& rows, const Matrix3d& rotation) {
  const VectorXd known = rows.leftCols<9>() * rotation.reshaped() + rows.col(kFactor);
  const Svd svd = SvdOf(rows.middleCols<3>(kT));
  const double scale = std::sqrt(Balls(stations));  // a singular value over it is about the rms turn
  if (svd.values[0] < kSmallestTurn_rad * scale)
    return Error{fmt::format(
        "{}: the poses do not rotate the flange: the translation of the hand-eye is not determined; turn the robot "
        "about two axes",
        Names(stations))};
  if (svd.values[2] < kSmallestTurn_rad * scale) {
    const Vector3d axis = svd.v.col(2);
    return Error{fmt::format(
        "{}: the poses rotate the flange about one axis only, ({:.2f}, {:.2f}, {:.2f}) of the flange: the translation "
        "of the hand-eye along it is not determined; turn the robot about a second axis",
        Names(stations), axis[0], axis[1], axis[2])};
  }
  return Vector3d(LeastSquares(rows.middleCols<3>(kT), -known));
}

// As if that reflector were the tool.
Measurements OnlyReflector(Measurements data, int reflector) {
  data.spheres = {{"", Vector3d::Zero()}};
  for (Station& station : data.stations) {
    for (Model::View& view : station.views) {
      std::erase_if(view.balls, [&](const Model::SeenBall& seen) { return seen.sphere != reflector; });
      for (Model::SeenBall& seen : view.balls) seen.sphere = 0;
    }
    std::erase_if(station.views, [](const Model::View& view) { return view.balls.empty(); });
  }
  return data;
}

// Each reflector has its place on the flange; of all turns that bring the line through both there the smallest.
Result<Isometry3d> OfTwoReflectors(const Measurements& data) {
  Vector3d on_flange[2];
  for (int k = 0; k < 2; ++k) {
    SCANCAL_ASSIGN_OR_RETURN(const Kinematics one, InitialHandEye(OnlyReflector(data, k)));
    on_flange[k] = one.flange_from_scanner.translation();
  }
  const Vector3d on_tool[2] = {data.spheres[0].centre, data.spheres[1].centre};
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() =
      Eigen::Quaterniond::FromTwoVectors(on_tool[1] - on_tool[0], on_flange[1] - on_flange[0]).toRotationMatrix();
  pose.translation() = (on_flange[0] + on_flange[1] - pose.linear() * (on_tool[0] + on_tool[1])) / 2;
  return pose;
}

bool OnALine(const MatrixXd& points) {
  const MatrixXd centred = points.colwise() - points.rowwise().mean();
  const VectorXd sigma = SvdOf(centred).values;
  return sigma.size() < 2 || sigma[1] < 1e-6 * sigma[0] || sigma[0] == 0;
}

}  // namespace

Isometry3d BaseFromScanner(const Measurements& data, const Kinematics& setup, const Model::View& view) {
  CHECK(setup.link_errors.empty() || setup.link_errors.size() == data.links.size());
  std::vector<Link> links = WithErrors(data.links, setup.link_errors);
  for (Link& link : links) {
    link.d *= 1 + setup.expansion * view.warmer;
    link.a *= 1 + setup.expansion * view.warmer;
  }
  return view.base_from_flange * BaseFromFlange(links, TurnedJoints(view.joints, view.terms, setup.joint_terms)) *
         setup.flange_from_scanner;
}

Result<Kinematics> InitialHandEye(const Measurements& data) {
  if (data.hand_eye) return Kinematics{*data.hand_eye, std::vector<Link>(data.links.size())};
  if (data.measured_in_world && data.spheres.size() == 2) {
    SCANCAL_ASSIGN_OR_RETURN(const Isometry3d pose, OfTwoReflectors(data));
    return Kinematics{pose, std::vector<Link>(data.links.size())};
  }
  const MatrixXd rows = AllRows(data);
  const bool is_point = data.measured_in_world && data.spheres.size() == 1;  // which has no turn
  SCANCAL_ASSIGN_OR_RETURN(const Matrix3d rotation,
                           is_point ? Result<Matrix3d>(Matrix3d::Identity()) : Rotation(data.stations, rows));
  SCANCAL_ASSIGN_OR_RETURN(const Vector3d translation, Translation(data.stations, rows, rotation));
  Kinematics setup;
  setup.flange_from_scanner.linear() = rotation;
  setup.flange_from_scanner.translation() = translation;
  setup.link_errors.resize(data.links.size());
  return setup;
}

Result<Vector3d> HandEyeTranslation(const Measurements& data, const Matrix3d& rotation) {
  return Translation(data.stations, AllRows(data), rotation);
}

Result<std::vector<Station>> StationsAt(const Measurements& data, const Kinematics& setup) {
  std::vector<Station> stations = data.stations;
  for (Station& station : stations) {
    Eigen::Matrix3Xd on_artifact(3, Balls(station)), in_base = on_artifact;
    Index k = 0;
    for (const Model::View& view : station.views) {
      const Isometry3d scanner = BaseFromScanner(data, setup, view);
      for (const Model::SeenBall& ball : view.balls) {
        on_artifact.col(k) = data.InWorld(ball);
        in_base.col(k++) = scanner * data.OnTool(ball);
      }
    }
    if (data.spheres.size() == 1 && !data.measured_in_world) {  // a single ball has a place and no turn
      station.base_from_artifact.translation() = in_base.rowwise().mean() - data.spheres[0].centre;
      continue;
    }
    if (OnALine(on_artifact))
      return Error{fmt::format(
          "station {}: the balls that are seen there lie on a line of the artifact: its pose is not determined; see "
          "three balls that do not",
          station.name)};
    station.base_from_artifact = MotionOnto(on_artifact, in_base);
  }
  return stations;
}

}  // namespace scancal::robot_ball
