#include "models/parts/declared_links.h"
#include <fmt/format.h>
#include <cmath>
#include <numbers>

namespace scancal {
namespace {

// Degrees declared as radians, and the other way round: nobody builds an axis at 1.5708 degrees.
void CheckAngle(double angle_rad, const char* key, YamlMap* row) {
  constexpr double kTurn_rad = 2 * std::numbers::pi, kNear = 1e-3;
  const double number = std::abs(angle_rad) * 360 / kTurn_rad;
  if (std::abs(angle_rad) > 2 * kTurn_rad)
    row->Fail(key, fmt::format("expected two turns at most, that is {:.4g} rad; are these degrees? See units: angle",
                               angle_rad));
  if (std::abs(number - kTurn_rad / 4) < kNear || std::abs(number - kTurn_rad / 2) < kNear)
    row->Fail(key, "expected an angle in degrees, that looks like radians; see units: angle");
}

void CheckReach(const std::vector<Link>& links, YamlMap* robot) {
  double reach = 0;
  for (const Link& link : links) reach += std::abs(link.d) + std::abs(link.a);
  if (reach < kLeastReach_mm || reach > kLargestReach_mm)
    robot->Fail("links", fmt::format("the arm is {:.3g} mm long, expected {} mm to {} mm; see units: length", reach,
                                     kLeastReach_mm, kLargestReach_mm));
}

}  // namespace

std::vector<Link> ReadLinks(YamlMap top, const Units& units) {
  std::vector<Link> links;
  if (!top.Has("robot")) return links;
  YamlMap robot = top.Map("robot");
  using enum Dimension;
  for (YamlMap row : robot.Maps("links")) {
    const auto length = [&](const char* key) { return row.Number(key) * units.Of(kLength); };
    const auto angle = [&](const char* key, std::optional<double> otherwise = {}) {
      const double value = row.Number(key, otherwise) * units.Of(kAngle);
      CheckAngle(value, key, &row);
      return value;
    };
    links.push_back({angle("theta", 0), length("d"), length("a"), angle("alpha"), angle("beta", 0)});
  }
  CheckReach(links, &robot);
  return links;
}

LinkSetting ReadLinkSetting(const Dataset& dataset) {
  LinkSetting setting;
  YamlMap top = dataset.yaml;
  for (const ParameterSetting& parameter : dataset.parameters) {
    if (parameter.name != "links") continue;
    YamlMap parameters = top.Map("parameters");
    setting.hold = parameter.role == "hold";
    if (parameter.role == "consider" || parameter.value.value_or(0) != 0 || parameter.u > 0)
      parameters.Fail("links", "expected estimate, hold, or {estimate: 0, u_length: ..., u_angle: ...}");
    if (!parameters.IsMap("links") || setting.hold) continue;
    YamlMap links = parameters.Map("links");
    setting.u_length = links.Number("u_length", 0) * dataset.units.length_in_mm;
    setting.u_angle = links.Number("u_angle", 0) * dataset.units.angle_in_rad;
    for (const auto& [key, u] : {std::pair{"u_length", setting.u_length}, {"u_angle", setting.u_angle}})
      if (u < 0) links.Fail(key, "expected a standard uncertainty, not negative");
  }
  return setting;
}

void SetLinks(const LinkSetting& setting, std::span<Quantity> links) {
  for (Quantity& quantity : links) {
    if (setting.hold) quantity.role = Role::kHold;
    if (quantity.role == Role::kEstimate) quantity.u = quantity.unit == Unit::kMm ? setting.u_length : setting.u_angle;
  }
}

}  // namespace scancal
