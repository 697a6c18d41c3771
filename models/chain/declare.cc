#include "models/chain/declare.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include "io/message.h"
#include "models/scanner.h"

namespace scancal {
namespace {

constexpr double kTurn_rad = 2 * std::numbers::pi;

// Degrees declared as radians, and the other way round: nobody builds an axis at 1.5708 degrees.
void CheckAngle(double angle_rad, const char* key, YamlMap* row) {
  constexpr double kNear = 1e-3;
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

bool IsLinkName(const std::string& name) {
  constexpr size_t kAnyArm = 20;
  Quantities links;
  DeclareLinks(kAnyArm, &links);
  return name == "links" || Find(links, name) >= 0;
}

std::string JointColumn(size_t joint) { return "q" + std::to_string(joint + 1); }

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

Eigen::Vector3d ReadGravity(YamlMap top) {
  Eigen::Vector3d gravity = -Eigen::Vector3d::UnitZ();
  if (!top.Has("robot")) return gravity;
  YamlMap robot = top.Map("robot");
  if (!robot.Has("gravity")) return gravity;
  YamlMap direction = robot.Map("gravity");
  gravity = {direction.Number("x", 0), direction.Number("y", 0), direction.Number("z", 0)};
  if (!(gravity.norm() > 0)) robot.Fail("gravity", "expected its direction in the base, for example {z: -1}");
  return gravity.normalized();
}

Result<void> SetSystematic(const InfluenceSetting& setting, const Dataset& dataset, std::span<Quantity> quantities) {
  if (setting.role == "yes" || setting.role == "no")
    return InFile(dataset, "influences: " + setting.name + ": found " + setting.role +
                               ", expected estimate, hold or a standard uncertainty");
  for (Quantity& quantity : quantities) {
    if (quantity.Source() != setting.name) continue;
    quantity.u = setting.u * UnitFactor(quantity.unit, dataset.units);
    quantity.role = setting.role == "estimate" ? Role::kEstimate : quantity.u > 0 ? Role::kConsider : Role::kHold;
  }
  return {};
}

Result<bool> SetJointTerms(const InfluenceSetting& setting, const Dataset& dataset, std::span<Quantity> terms,
                           std::vector<std::string>* known) {
  std::set<std::string> sources;
  for (const Quantity& term : terms) {
    const std::string kind = term.source.substr(0, term.source.rfind('_'));
    sources.insert({kind, term.source});
    if (setting.name != kind && setting.name != term.source) continue;
    InfluenceSetting of_term = setting;
    of_term.name = term.source;
    SCANCAL_RETURN_IF_ERROR(SetSystematic(of_term, dataset, terms));
  }
  known->insert(known->end(), sources.begin(), sources.end());
  return sources.contains(setting.name);
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

Result<void> SetParameters(const Dataset& dataset, const LinkSetting& setting, size_t links, int first_link,
                           int without_nominal, std::span<Quantity> quantities) {
  for (Quantity& quantity : quantities.subspan(first_link, kLinkNumbers * links)) {
    if (setting.hold) quantity.role = Role::kHold;
    if (quantity.role == Role::kEstimate) quantity.u = quantity.unit == Unit::kMm ? setting.u_length : setting.u_angle;
  }
  for (const ParameterSetting& parameter : dataset.parameters) {
    if (links == 0 && IsLinkName(parameter.name))
      return InFile(dataset, "parameters: " + parameter.name +
                                 ": the poses are those of the flange, expected robot: links and joint angles for a "
                                 "kinematics to be estimated");
    if (parameter.name != "links")
      SCANCAL_RETURN_IF_ERROR(SetDeclared(parameter, dataset, {"links"}, without_nominal, quantities));
  }
  return {};
}

Result<void> SetNoise(const InfluenceSetting& setting, const Dataset& dataset, const std::string& every,
                      std::span<Quantity> quantities) {
  const std::string place = "influences: " + setting.name + ": ";
  if (setting.role == "yes" || setting.role == "no")
    return InFile(dataset, place + "found " + setting.role + ", expected a standard uncertainty");
  if (setting.role == "estimate" && setting.u > 0)
    return InFile(dataset, place + "its variance is estimated without a prior, expected estimate or a number");
  if (!every.empty() && setting.role != "estimate" && setting.u == 0)
    return InFile(dataset, place + "expected more than 0, or estimate: every " + every + " has noise");
  for (Quantity& quantity : quantities) {
    if (quantity.source != setting.name) continue;
    quantity.u = setting.u * UnitFactor(quantity.unit, dataset.units);
    quantity.role = setting.role == "estimate" ? Role::kEstimate : quantity.u > 0 ? Role::kConsider : Role::kHold;
  }
  return {};
}

std::vector<TableColumn> JointColumns(size_t joints, const std::string& remedy) {
  std::vector<TableColumn> columns;
  for (size_t k = 0; k < joints; ++k)
    columns.push_back({JointColumn(k), Cells::kNumber, Dimension::kAngle, true, remedy});
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
