#include "models/parts/figure_tables.h"
#include <algorithm>

namespace scancal {

NumberTable TableOf(const std::vector<std::pair<std::string, Unit>>& columns) {
  NumberTable table;
  for (const auto& [name, unit] : columns) {
    table.columns.push_back(name);
    table.units.push_back(unit);
  }
  return table;
}

NumberTable PointTable() { return TableOf({{"X", Unit::kMm}, {"Y", Unit::kMm}, {"Z", Unit::kMm}}); }

void AddPoint(const Eigen::Vector3d& p, NumberTable* points) { points->rows.push_back({p[0], p[1], p[2]}); }

NumberTable SightTable() {
  using enum Unit;
  return TableOf({{"from_X", kMm}, {"from_Y", kMm}, {"from_Z", kMm}, {"to_X", kMm}, {"to_Y", kMm}, {"to_Z", kMm}});
}

void AddSight(const Eigen::Vector3d& from, const Eigen::Vector3d& to, NumberTable* sights) {
  sights->rows.push_back({from[0], from[1], from[2], to[0], to[1], to[2]});
}

NumberTable PoseTable(size_t joints, const std::vector<std::pair<std::string, Unit>>& more) {
  std::vector<std::pair<std::string, Unit>> columns;
  for (size_t k = 1; k <= joints; ++k) columns.push_back({"q" + std::to_string(k), Unit::kRad});
  for (const char* axis : {"x", "y", "z"}) columns.push_back({axis, Unit::kMm});
  columns.insert(columns.end(), more.begin(), more.end());
  return TableOf(columns);
}

void AddPose(const std::vector<double>& joints, const Eigen::Vector3d& flange, const std::vector<double>& more,
             NumberTable* poses) {
  std::vector<double>& row = poses->rows.emplace_back(joints);
  row.insert(row.end(), flange.begin(), flange.end());
  row.insert(row.end(), more.begin(), more.end());
}

NumberTable PointResidualTable() {
  return TableOf({{"pose", Unit::kOne}, {"x", Unit::kMm}, {"y", Unit::kMm}, {"z", Unit::kMm}});
}

void AddNominal(const std::vector<Link>& links, Calibration* calibration) {
  for (size_t k = 0; k < links.size(); ++k) {
    const Link& link = links[k];
    for (const auto& [name, number] : {std::pair{"theta_", link.theta},
                                       {"d_", link.d},
                                       {"a_", link.a},
                                       {"alpha_", link.alpha},
                                       {"beta_", link.beta}}) {
      const auto parameter =
          std::find_if(calibration->parameters.begin(), calibration->parameters.end(),
                       [full = name + std::to_string(k + 1)](const Parameter& each) { return each.name == full; });
      if (parameter != calibration->parameters.end()) parameter->nominal = number;
    }
  }
}

}  // namespace scancal
