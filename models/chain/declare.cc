#include "models/chain/declare.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <set>
#include "io/input_file.h"
#include "io/json_file.h"
#include "io/message.h"
#include "io/number.h"
#include "models/chain/urdf.h"
#include "models/scanner.h"

namespace scancal {
namespace {

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

std::vector<Link> ReadLinks(YamlMap robot, const Units& units) {
  using enum Dimension;
  std::vector<Link> links;
  for (YamlMap row : robot.Maps("links")) {
    const auto length = [&](const char* key) { return row.Number(key) * units.Of(kLength); };
    const auto angle = [&](const char* key, std::optional<double> otherwise = {}) {
      const double value = row.Number(key, otherwise) * units.Of(kAngle);
      CheckAngle(value, key, &row);
      return value;
    };
    links.push_back({angle("theta", 0), length("d"), length("a"), angle("alpha"), angle("beta", 0)});
  }
  return links;
}

Eigen::Vector3d ReadGravity(YamlMap robot) {
  if (!robot.Has("gravity")) return -Eigen::Vector3d::UnitZ();
  YamlMap direction = robot.Map("gravity");
  const Eigen::Vector3d gravity(direction.Number("x", 0), direction.Number("y", 0), direction.Number("z", 0));
  if (!(gravity.norm() > 0)) robot.Fail("gravity", "expected its direction in the base, for example {z: -1}");
  return gravity.normalized();
}

// Turns of each motor for one of its joint.
std::vector<double> ReadGearRatios(YamlMap robot, size_t joints) {
  std::vector<double> ratios;
  if (!robot.Has("gear_ratio")) return ratios;
  for (const std::string& text : robot.Texts("gear_ratio")) {
    const ParsedNumber number = ParseNumber(text);
    ratios.push_back(number.value);
    if (number.kind != NumberKind::kNumber || (number.value != 0 && std::abs(number.value) <= 1))
      robot.Fail("gear_ratio", Quoted(text) +
                                   ": expected how often a motor turns for one turn of its joint, more "
                                   "than once, or 0 where nobody knows");
  }
  if (ratios.size() != joints)
    robot.Fail("gear_ratio", fmt::format("expected {} numbers, one a joint; 0 where nobody knows", joints));
  return ratios;
}

Result<void> TakeUrdf(const Dataset& dataset, YamlMap robot, Arm* arm) {
  constexpr int64_t kLargest = int64_t{32} << 20;  // bytes
  const std::string name = robot.Text("urdf"), base = robot.Text("base", ""), tip = robot.Text("tip", "");
  arm->urdf_file = dataset.file.parent_path() / name;
  arm->urdf = dataset.urdf;
  if (arm->urdf.empty()) {
    SCANCAL_ASSIGN_OR_RETURN(arm->urdf, ReadText(arm->urdf_file, kLargest));
  }
  SCANCAL_ASSIGN_OR_RETURN(const auto joints, ReadUrdf(arm->urdf, arm->urdf_file.string(), base, tip));
  SCANCAL_ASSIGN_OR_RETURN(UrdfLinks found, LinksOfUrdf(joints, arm->urdf_file.string()));
  arm->links = std::move(found.links);
  arm->joints = std::move(found.joints);
  arm->base_from_first = found.base_from_first;
  arm->gravity = found.base_from_first.linear().transpose() * arm->gravity;
  return {};
}

}  // namespace

Result<Arm> ReadArm(const Dataset& dataset) {
  Arm arm;
  YamlMap top = dataset.yaml;
  if (!top.Has("robot")) return arm;
  YamlMap robot = top.Map("robot");
  arm.gravity = ReadGravity(robot);
  if (robot.Has("urdf")) {
    if (robot.Has("links")) {
      robot.Fail("links", "expected links or a urdf, not both");
      return arm;
    }
    SCANCAL_RETURN_IF_ERROR(TakeUrdf(dataset, robot, &arm));
  } else {
    arm.links = ReadLinks(robot, dataset.units);
  }
  CheckReach(arm.links, &robot);
  arm.couplings = ReadCouplings(top, arm.links.size());
  arm.gear_ratios = ReadGearRatios(robot, arm.links.size());
  return arm;
}

void KeepUrdf(const Arm& arm, Json* data) {
  if (!arm.urdf.empty()) (*data)["urdf"] = arm.urdf;
}

Dataset WithUrdf(const Dataset& dataset, const Json& data) {
  Dataset with = dataset;
  if (data.contains("urdf") && data["urdf"].is_string()) with.urdf = data["urdf"].get<std::string>();
  return with;
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

Result<void> CheckMotors(const InfluenceSetting& setting, const Arm& arm, const Dataset& dataset) {
  constexpr std::string_view kMotor = "motor";
  const std::string& name = setting.name;
  if (!name.starts_with(kMotor) || setting.role == "hold") return {};
  for (size_t k = 0; k < arm.links.size(); ++k) {
    const bool meant = name == kMotor || name == fmt::format("{}_{}", kMotor, k + 1);
    if (meant && k < arm.gear_ratios.size() && arm.gear_ratios[k] != 0) return {};
  }
  return InFile(dataset, "influences: " + name +
                             ": nobody said how often the motor turns for one turn of its joint; declare robot: "
                             "{gear_ratio: [121, 121, 101, ...]}, 0 where it is not known");
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
      else if (u == 0 && links.Has(key))
        links.Fail(key, fmt::format("expected a standard uncertainty above 0; leave {} out where there is no prior, or "
                                    "say links: hold where all of them are exactly known",
                                    key));
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

TableDeclaration ReadTableDeclaration(YamlMap map, const std::string& key, const Dataset& dataset,
                                      const std::vector<TableColumn>& columns, bool with_turns) {
  TableDeclaration table;
  table.format.units = dataset.units;
  const bool is_map = map.IsMap(key);
  YamlMap own = is_map ? map.Map(key) : YamlMap();
  if (with_turns && own.Has("orientation")) {
    table.names_orientation = true;
    auto named = Orientation::Named(own.Text("orientation"));
    if (named.ok()) table.orientation = *std::move(named);
    else own.Fail("orientation", named.error().message);
  }
  for (const TableColumn& column : columns) table.format.columns.push_back({column.name, column.dimension});
  for (const TableColumn& column : table.orientation.Columns(true, ""))
    if (with_turns) table.format.columns.push_back({column.name, column.dimension});
  YamlMap top = dataset.yaml;
  if (top.IsMap("columns")) {
    YamlMap names = top.Map("columns");
    for (const ScanColumn& column : table.format.columns)
      if (names.Has(column.name)) table.format.names[column.name] = names.Text(column.name);
  } else if (top.Has("columns")) {
    top.Fail("columns", "expected a mapping of names, {q1: A1}; names in the order of a file belong to one table: " +
                            key + ": {file: ..., columns: [...]}");
  }
  ReadTextFormat(top, &table.format);
  ReadTextFormat(own, &table.format);
  ReadColumnNames(own, &table.format);
  if (own.Has("units")) table.format.units = ReadUnits(own.Map("units"), dataset.units);
  const std::string file = is_map ? own.Text("file") : map.Text(key);
  if (file.empty()) map.Fail(key, "expected the path of a table");
  table.format.path = dataset.file.parent_path() / file;
  return table;
}

void CheckColumnNames(YamlMap top, const std::vector<const TableDeclaration*>& tables) {
  if (!top.IsMap("columns")) return;
  YamlMap names = top.Map("columns");
  for (const std::string& name : names.Keys()) {
    const bool known = std::any_of(tables.begin(), tables.end(),
                                   [&](const TableDeclaration* table) { return table->format.names.contains(name); });
    if (!known) names.Fail(name, "no column has this name here; the file's own name stands behind the colon");
  }
}

std::vector<Coupling> ReadCouplings(YamlMap top, size_t joints) {
  std::vector<Coupling> couplings;
  if (!top.Has("robot")) return couplings;
  YamlMap robot = top.Map("robot");
  if (!robot.Has("coupled")) return couplings;
  YamlMap coupled = robot.Map("coupled");
  for (const std::string& name : coupled.Keys()) {
    std::string text = coupled.Text(name);
    std::erase(text, ' ');
    std::optional<Coupling> found;
    for (size_t joint = 0; joint < joints; ++joint)
      for (size_t with = 0; with < joints; ++with)
        for (const char sign : {'+', '-'})
          if (joint != with && name == JointColumn(joint) && text == name + sign + JointColumn(with))
            found = Coupling{joint, with, sign == '+' ? 1.0 : -1.0};
    if (found) couplings.push_back(*found);
    else
      coupled.Fail(name, fmt::format("expected by what a joint turns that is coupled to another, {{q3: q3 + q2}} or "
                                     "{{q3: q3 - q2}}, of q1 to q{}",
                                     joints));
  }
  return couplings;
}

std::string Said(const std::vector<Coupling>& couplings) {
  std::string text;
  for (const Coupling& each : couplings)
    text += fmt::format(" Joint {} turns by {} {} {}.", each.joint + 1, JointColumn(each.joint),
                        each.times > 0 ? '+' : '-', JointColumn(each.with));
  return text;
}

std::vector<double> Uncoupled(const std::vector<double>& shown, const std::vector<Coupling>& couplings) {
  std::vector<double> joints = shown;
  for (const Coupling& each : couplings) joints[each.joint] += each.times * shown[each.with];
  return joints;
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
    return Error{table.name() + ": found the column " + table.Called(JointColumn(joints)) + ", expected " +
                 std::to_string(joints) + " joints, one a row of robot: links"};
  double largest = 0;
  for (size_t k = 0; k < joints; ++k) {
    const std::vector<double>& angles = table.Numbers(JointColumn(k));
    for (size_t row = 0; row < table.rows(); ++row) {
      if (std::abs(angles[row]) > 2 * kTurn_rad) {
        const std::string pose = table.Has("pose") ? " in pose " + Quoted(table.Text("pose", row)) : "";
        return table.Wrong(
            row, JointColumn(k),
            fmt::format("that is {:.4g} rad{}, expected two turns at most; are these degrees? See units: "
                        "angle, or name the column {}_deg",
                        angles[row], pose, JointColumn(k)));
      }
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

std::vector<double> JointsOf(const Table& table, size_t row, size_t joints, const std::vector<Coupling>& couplings) {
  std::vector<double> angles;
  for (size_t k = 0; k < joints; ++k) angles.push_back(table.Number(JointColumn(k), row));
  return Uncoupled(angles, couplings);
}

}  // namespace scancal
