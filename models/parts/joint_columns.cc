#include "models/parts/joint_columns.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include "io/units.h"

namespace scancal {
namespace {

constexpr double kTurn_rad = 2 * std::numbers::pi;

}  // namespace

std::string JointColumn(size_t joint) { return "q" + std::to_string(joint + 1); }

std::vector<TableColumn> JointColumns(size_t joints) {
  std::vector<TableColumn> columns;
  for (size_t k = 0; k < joints; ++k) columns.push_back({JointColumn(k), Cells::kNumber, Dimension::kAngle});
  columns.push_back({JointColumn(joints), Cells::kNumberOrNothing, Dimension::kAngle, false});
  return columns;
}

Result<void> CheckJoints(const Table& table, size_t joints) {
  if (table.Has(JointColumn(joints)))
    return Error{table.name() + ": found the column " + JointColumn(joints) + ", expected " + std::to_string(joints) +
                 " joints, one a row of robot: links"};
  double largest = 0;
  for (size_t k = 0; k < joints; ++k) {
    const std::vector<double>& angles = table.Numbers(JointColumn(k));
    for (size_t row = 0; row < table.rows(); ++row) {
      if (std::abs(angles[row]) > 2 * kTurn_rad)
        return table.Wrong(row, JointColumn(k),
                           fmt::format("that is {:.4g} rad, expected two turns at most; are these degrees? See units: "
                                       "angle, or name the column {}_deg",
                                       angles[row], JointColumn(k)));
      largest = std::max(largest, std::abs(angles[row]));
    }
  }
  if (joints > 0 && largest <= kTurn_rad * kDegree)
    return Error{
        fmt::format("{}: all joint angles lie within {:.3g} deg, expected a robot that moves; are these "
                    "radians? See units: angle, or name the columns q1_rad ...",
                    table.name(), largest / kDegree)};
  return {};
}

std::vector<double> JointsOf(const Table& table, size_t row, size_t joints) {
  std::vector<double> angles;
  for (size_t k = 0; k < joints; ++k) angles.push_back(table.Number(JointColumn(k), row));
  return angles;
}

}  // namespace scancal
