#include "models/parts/declared_parameter.h"
#include "io/message.h"

namespace scancal {

Error InFile(const Dataset& dataset, const std::string& sentence) { return {dataset.file.string() + ": " + sentence}; }

double UnitFactor(Unit unit, const Units& units) {
  return units.Of(unit == Unit::kMm ? Dimension::kLength : unit == Unit::kRad ? Dimension::kAngle : Dimension::kNone);
}

Result<int> SetDeclared(const ParameterSetting& setting, const Dataset& dataset, std::vector<std::string> others,
                        int without_nominal, std::span<Quantity> quantities) {
  const std::string place = "parameters: " + setting.name + ": ";
  int index = -1;
  for (int k = 0; k < std::ssize(quantities); ++k) {
    if (quantities[k].scope != Scope::kSystem) continue;
    if (quantities[k].name == setting.name) index = k;
    others.push_back(quantities[k].name);
  }
  if (index < 0) return InFile(dataset, place + "unknown parameter" + Suggestion(setting.name, others));
  Quantity& quantity = quantities[index];
  quantity.role = setting.role == "estimate"   ? Role::kEstimate
                  : setting.role == "consider" ? Role::kConsider
                                               : Role::kHold;
  const double unit = UnitFactor(quantity.unit, dataset.units);
  quantity.value = setting.value.value_or(0) * unit;
  quantity.u = setting.u * unit;
  if (index < without_nominal && quantity.role != Role::kEstimate && !setting.value)
    return InFile(dataset, place + setting.role + ": expected its value, for example {" + setting.role + ": 123}");
  return index;
}

}  // namespace scancal
