#include "models/robot_ball/observations.h"
#include <fmt/format.h>
#include "io/message.h"
#include "models/robot_ball/ball_points.h"

namespace scancal {
namespace {

Result<Table> ReadTable(const std::filesystem::path& path, const Units& units) {
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

}  // namespace

Result<Observations> ReadObservations(const std::filesystem::path& path, const std::filesystem::path& folder,
                                      const Units& units, double ball_diameter) {
  Observations result;
  SCANCAL_ASSIGN_OR_RETURN(result.table, ReadTable(path, units));
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

}  // namespace scancal
