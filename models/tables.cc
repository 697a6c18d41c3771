#include "models/tables.h"

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

}  // namespace scancal
