#include "models/parts/declared_links.h"

namespace scancal {

std::vector<Link> ReadLinks(YamlMap top, const Units& units) {
  std::vector<Link> links;
  YamlMap robot = top.Map("robot");
  for (YamlMap row : robot.Maps("links")) {
    using enum Dimension;
    const auto number = [&](const char* key, Dimension dimension, std::optional<double> otherwise = {}) {
      return row.Number(key, otherwise) * units.Of(dimension);
    };
    links.push_back({number("theta", kAngle, 0), number("d", kLength), number("a", kLength), number("alpha", kAngle),
                     number("beta", kAngle, 0)});
  }
  if (links.empty()) robot.Fail("links", "expected one row a joint, base to flange");
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

}  // namespace scancal
