#include "models/robot_ball/poses.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include "models/parts/joint_columns.h"

namespace scancal {
namespace {

constexpr double kNormTolerance = 1e-3;  // a quaternion written with four digits
const std::vector<std::string> kQuaternion = {"qx", "qy", "qz", "qw"};

std::vector<TableColumn> Columns(size_t joints) {
  std::vector<TableColumn> columns = {{"station"}, {"pose"}};
  if (joints > 0) {
    for (const TableColumn& column : JointColumns(joints)) columns.push_back(column);
    return columns;
  }
  for (const char* axis : {"x", "y", "z"}) columns.push_back({axis, Cells::kNumber, Dimension::kLength});
  for (const std::string& part : kQuaternion) columns.push_back({part, Cells::kNumber});
  return columns;
}

Result<Table> ReadTable(const std::filesystem::path& path, size_t joints, const Units& units) {
  auto table = Table::Read(path, Columns(joints), units);
  if (!table.ok() && table.error().kind == ErrorKind::kMissingColumns)
    return Error{table.error().message + (joints > 0 ? "; robot: links declares " + std::to_string(joints) +
                                                           " joints, without it the poses are those of the flange"
                                                     : "; joint angles need robot: links in dataset.yaml")};
  return table;
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

}  // namespace

Result<PoseTable> ReadPoses(const std::filesystem::path& path, const std::vector<Link>& links, const Units& units) {
  SCANCAL_ASSIGN_OR_RETURN(Table table, ReadTable(path, links.size(), units));
  if (!links.empty()) SCANCAL_RETURN_IF_ERROR(CheckJoints(table, links.size()));
  PoseTable poses;
  std::unordered_map<std::string, size_t> stations;
  for (size_t row = 0; row < table.rows(); ++row) {
    const std::string& name = table.Text("pose", row);
    RobotBall::View view;
    view.name = name;
    view.joints = JointsOf(table, row, links.size());
    if (links.empty()) {
      SCANCAL_ASSIGN_OR_RETURN(view.base_from_flange, FlangeOf(table, row));
    }
    const size_t station = stations.try_emplace(table.Text("station", row), stations.size()).first->second;
    if (station == poses.stations.size()) poses.stations.push_back({table.Text("station", row), {}});
    std::vector<RobotBall::View>& views = poses.stations[station].views;
    const auto [place, is_new] = poses.places.try_emplace(name, PoseTable::Place{station, views.size(), row});
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

}  // namespace scancal
