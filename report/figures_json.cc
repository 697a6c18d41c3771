#include "report/figures_json.h"
#include <algorithm>
#include <cmath>

namespace scancal {

Json Number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json ToJson(const NumberTable& table) {
  Json units = Json::array(), rows = Json::array();
  for (const Unit unit : table.units) units.push_back(Name(unit));
  for (const std::vector<double>& row : table.rows) {
    Json numbers = Json::array();
    for (const double number : row) numbers.push_back(Number(number));
    rows.push_back(std::move(numbers));
  }
  Json json = {{"columns", table.columns}, {"units", units}, {"rows", rows}};
  if (!table.names.empty()) json["names"] = table.names;
  return json;
}

Json ToJson(const NumberTables& tables) {
  Json json = Json::object();
  for (const auto& [name, table] : tables) json[name] = ToJson(table);
  return json;
}

Json SceneJson(const std::vector<TargetSummary>& targets) {
  Json list = Json::array();
  for (const TargetSummary& target : targets) {
    if (target.scene.empty()) continue;
    list.push_back({{"name", target.name}});
    list.back().update(ToJson(target.scene));
  }
  return list.empty() ? Json::object() : Json{{"targets", list}};
}

Json ToJson(const Comparison& comparison) {
  Json list = Json::array();
  for (const ComparisonRow& row : comparison.rows) {
    Json cells = Json::array();
    for (size_t k = 0; k < row.cells.size(); ++k) {
      const ComparisonCell& cell = row.cells[k];
      if (comparison.columns[k].is_time) continue;
      cells.push_back({{"column", comparison.columns[k].name},
                       {"value", cell.value ? Number(*cell.value) : Json(nullptr)},
                       {"u", cell.u > 0 ? Number(cell.u) : Json(nullptr)}});
    }
    list.push_back({{"method", row.method}, {"note", row.note}, {"cells", cells}});
  }
  return list;
}

}  // namespace scancal
