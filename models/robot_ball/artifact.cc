#include "models/robot_ball/artifact.h"
#include <fmt/format.h>
#include <cmath>
#include <limits>
#include <unordered_map>
#include "io/message.h"

namespace scancal {

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
    for (const RobotBall::Sphere& other : artifact.spheres)
      if (centre == other.centre)
        return table.Wrong(row, "x", "ball " + Quoted(name) + " lies where " + Quoted(other.name) + " does");
    artifact.spheres.push_back({name, centre});
    artifact.u.push_back(table.Has("u") ? table.Number("u", row) : std::numeric_limits<double>::quiet_NaN());
    if (artifact.u.back() < 0) return table.Wrong(row, "u", "expected a standard uncertainty, not negative");
  }
  artifact.table = std::move(table);
  return artifact;
}

}  // namespace scancal
