#include "io/dataset.h"
#include <nlohmann/json.hpp>
#include <utility>
#include "io/input_file.h"
#include "io/message.h"

namespace scancal {
namespace {

constexpr int kVersion = 1;
constexpr double kLargest = 1e6;                    // u
constexpr int64_t kLargestFile = int64_t{4} << 20;  // bytes; it declares, and has no data
const std::vector<std::string>& Roles() {
  static const std::vector<std::string> roles = {"estimate", "consider", "hold"};
  return roles;
}

void CheckVersion(YamlMap& yaml) {
  const double version = yaml.Number("scancal");
  if (version == kVersion) return;
  const std::string expected = "expected " + std::to_string(kVersion) + ", the version of the format";
  yaml.Fail("scancal", version > kVersion ? expected + "; the data set is made for a newer scancal" : expected);
}

// M: estimate
ParameterSetting ReadRole(YamlMap& parameters, const std::string& name) {
  ParameterSetting setting{.name = name, .role = parameters.Text(name), .value = {}};
  if (setting.role == "consider") {
    parameters.Fail(name, "expected its standard uncertainty as well: {consider: 0, u: ...}");
  } else if (setting.role != "estimate" && setting.role != "hold") {
    const std::string nearest = Nearest(setting.role, Roles());
    parameters.Fail(name,
                    "expected estimate, hold, {hold: value}, {consider: value, u: ...} or {estimate: value, u: ...}" +
                        (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }
  return setting;
}

// The one role among the keys of {estimate: 123, u: 0.5}; empty, with a complaint, if there is none or another.
std::string FindRole(YamlMap& yaml) {
  std::string role;
  for (const std::string& candidate : Roles()) {
    if (!yaml.Has(candidate)) continue;
    if (!role.empty()) {
      yaml.Fail("", "found the roles " + Listed({role, candidate}) + ", expected one of them");
      return "";
    }
    role = candidate;
  }
  if (!role.empty()) return role;
  for (const std::string& key : yaml.Keys()) {
    if (key != "u") yaml.Fail(key, "unknown role '" + key + "'" + Suggestion(key, Roles()));
  }
  yaml.Fail("", "found no role, expected one of: " + Listed(Roles()));
  return "";
}

// Larger than any in any unit; what a model can say more exactly, it says.
void CheckSize(YamlMap& yaml, const std::string& key, double u) {
  if (u > kLargest) yaml.Fail(key, "expected a standard uncertainty in the declared unit, below 1e6");
}

// M: {estimate: 123, u: 0.5}
ParameterSetting ReadRoleWithValue(YamlMap yaml, const std::string& name) {
  ParameterSetting setting{.name = name, .role = FindRole(yaml), .value = {}};
  if (setting.role.empty()) return setting;
  setting.value = yaml.Number(setting.role);
  if (setting.role == "hold") {
    if (yaml.Has("u")) yaml.Fail("u", "a parameter on hold has no uncertainty; did you mean {consider: ..., u: ...}?");
    return setting;
  }
  const bool consider = setting.role == "consider";
  setting.u = consider ? yaml.Number("u") : yaml.Number("u", 0);
  if (setting.u < 0) yaml.Fail("u", "expected a standard uncertainty, not negative");
  if (setting.u == 0 && consider) yaml.Fail("u", "expected more than 0; without uncertainty it is {hold: ...}");
  if (setting.u == 0 && !consider && yaml.Has("u"))
    yaml.Fail("u", "expected more than 0; without a prior it is " + name + ": estimate");
  CheckSize(yaml, "u", setting.u);
  return setting;
}

std::vector<ParameterSetting> ReadParameters(YamlMap yaml) {
  std::vector<ParameterSetting> settings;
  for (const std::string& name : yaml.Keys()) {
    settings.push_back(yaml.IsMap(name) ? ReadRoleWithValue(yaml.Map(name), name) : ReadRole(yaml, name));
  }
  return settings;
}

InfluenceSetting ReadInfluence(YamlMap& influences, const std::string& name) {
  constexpr auto kExpected = "expected a standard uncertainty of 0 or more, or estimate";
  InfluenceSetting setting{.name = name, .role = "consider"};
  if (influences.IsMap(name)) {
    const ParameterSetting role = ReadRoleWithValue(influences.Map(name), name);
    if (role.value.value_or(0) != 0) influences.Fail(name, "an influence is zero but for its uncertainty");
    setting.role = role.role;
    setting.u = role.u;
  } else if (influences.IsNumber(name)) {
    setting.u = influences.Number(name);
    if (setting.u < 0) influences.Fail(name, kExpected);
    CheckSize(influences, name, setting.u);
  } else {
    setting.role = influences.Text(name);
    if (setting.role == "true") setting.role = "yes";
    if (setting.role == "false") setting.role = "no";
    if (setting.role != "estimate" && setting.role != "hold" && setting.role != "yes" && setting.role != "no")
      influences.Fail(name, kExpected);
  }
  return setting;
}

std::vector<InfluenceSetting> ReadInfluences(YamlMap yaml) {
  std::vector<InfluenceSetting> settings;
  for (const std::string& name : yaml.Keys()) settings.push_back(ReadInfluence(yaml, name));
  return settings;
}

}  // namespace

Units ReadUnits(YamlMap yaml, const std::optional<Units>& otherwise) {
  Units units;
  units.length = yaml.Text("length", otherwise ? std::optional(otherwise->length) : std::nullopt);
  units.angle = yaml.Text("angle", otherwise ? std::optional(otherwise->angle) : std::nullopt);
  const auto length = UnitSize(units.length, Dimension::kLength);
  const auto angle = UnitSize(units.angle, Dimension::kAngle);
  if (!length) yaml.Fail("length", "expected mm, m or um");
  if (!angle) yaml.Fail("angle", "expected deg or rad");
  units.length_in_mm = length.value_or(1);
  units.angle_in_rad = angle.value_or(1);
  return units;
}

Result<Dataset> ReadDataset(const std::filesystem::path& folder) {
  std::error_code ignored;
  const std::filesystem::path file = std::filesystem::is_directory(folder, ignored) ? folder / "dataset.yaml" : folder;
  SCANCAL_ASSIGN_OR_RETURN(std::string text, ReadText(file, kLargestFile));
  return ParseDataset(std::move(text), file, file.string());
}

Result<Dataset> ParseDataset(std::string text, const std::filesystem::path& file, const std::string& name) {
  Dataset dataset;
  dataset.file = file;
  SCANCAL_ASSIGN_OR_RETURN(dataset.yaml, YamlMap::Parse(text, name));
  dataset.text = std::move(text);
  YamlMap& yaml = dataset.yaml;
  CheckVersion(yaml);  // first: what follows may mean something else in another version
  dataset.model = yaml.Text("model");
  dataset.name = yaml.Text("name", "");
  dataset.units = ReadUnits(yaml.Map("units"));
  if (yaml.Has("parameters")) dataset.parameters = ReadParameters(yaml.Map("parameters"));
  if (yaml.Has("influences")) dataset.influences = ReadInfluences(yaml.Map("influences"));
  if (yaml.Has("certificate")) dataset.certificate = std::make_shared<const Json>(yaml.Json("certificate"));
  SCANCAL_RETURN_IF_ERROR(yaml.Check());
  return dataset;
}

}  // namespace scancal
