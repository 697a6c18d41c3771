#include "models/turntable/declare.h"
#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include "io/message.h"
#include "models/scanner.h"

namespace scancal::turntable {
namespace {

// Longer search intervals than any turntable has: metres declared for millimetres.
constexpr double kImplausibleOffset_mm = 20'000;
constexpr double kMostNodesDeclared = 1e9;

const std::map<std::string, Dimension, std::less<>> kColumns = {
    {"angle", Dimension::kAngle}, {"bearing", Dimension::kAngle},   {"y", Dimension::kLength},
    {"z", Dimension::kLength},    {"range", Dimension::kLength},    {"profile", Dimension::kNone},
    {"time", Dimension::kNone},   {"temperature", Dimension::kNone}};

Dimension DimensionOf(std::string_view column) {
  const auto found = kColumns.find(column);
  return found == kColumns.end() ? Dimension::kNone : found->second;
}

// Of a line or a column: 1 or more.
bool IsWhole(double number) { return number >= 1 && number <= 1e9 && std::floor(number) == number; }

std::optional<WideLayout> ReadLayout(YamlMap map) {
  if (!map.Has("layout")) return std::nullopt;
  YamlMap layout = map.Map("layout");
  WideLayout wide;
  wide.tall = layout.Has("tall");
  wide.image = !wide.tall && layout.Has("image");
  const char* const kind = wide.tall ? "tall" : wide.image ? "image" : "wide";
  wide.value = layout.Text(kind);
  if (wide.value != "y" && wide.value != "range") layout.Fail(kind, "expected y or range");
  wide.across = wide.value == "range" ? "bearing" : "z";
  const auto column = [&](const char* key, int otherwise) {
    const double number = layout.Number(key, otherwise);
    if (IsWhole(number)) return static_cast<int>(number);
    layout.Fail(key, "expected a column number, 1 or more");
    return otherwise;
  };
  wide.angle_column = wide.image ? 0 : column(wide.tall ? "across_column" : "angle_column", 1);
  wide.first_column = wide.image ? 1 : column("first_column", 2);
  wide.scaled = layout.Has("scale");
  wide.scale = layout.Number("scale", 1);
  wide.offset = layout.Number("offset", 0);
  if (wide.scale == 0) layout.Fail("scale", "expected what a cell's number is to be multiplied by, not 0");
  if (wide.tall) return wide;
  wide.start = layout.Number("start");
  wide.step = layout.Number("step");
  if (wide.step == 0) layout.Fail("step", "expected a step that is not zero");
  return wide;
}

void ReadKeep(YamlMap target, const Units& units, ScanDeclaration* scan) {
  if (!target.Has("keep")) return;
  YamlMap keep = target.Map("keep");
  for (const std::string& column : keep.Keys()) {
    const std::array<double, 2> interval = keep.Interval(column);
    if (column == "lines") {
      if (IsWhole(interval[0]) && IsWhole(interval[1])) {
        scan->format.lines = {static_cast<int64_t>(interval[0]), static_cast<int64_t>(interval[1])};
      } else {
        keep.Fail(column, "expected whole line numbers, the first line is 1");
      }
    } else {
      const double unit = units.Of(DimensionOf(column));
      scan->keep.push_back({column, interval[0] * unit, interval[1] * unit});
    }
  }
}

// Defaults for all targets stand at the top level, a target's own override them.
ScanDeclaration ReadTarget(YamlMap target, const YamlMap& top, const Dataset& dataset) {
  ScanDeclaration scan;
  scan.name = target.Text("name");
  if (scan.name.empty()) target.Fail("name", "expected a name");
  scan.scan = target.Text("scan");
  if (scan.scan.empty()) target.Fail("scan", "expected the path of a scan file, or - for the standard input");
  scan.format = ScanFormatOf(scan.scan == "-" ? "/dev/stdin" : dataset.file.parent_path() / scan.scan, dataset.units);
  for (const YamlMap& map : {top, target}) ReadScanFormat(map, dataset.file.parent_path(), &scan.format);
  ReadKeep(target, dataset.units, &scan);
  for (YamlMap map : {top, target}) {
    if (!map.Has("planes")) continue;
    scan.planes = map.Text("planes");
    scan.planes_place = map.Where("planes");
    if (scan.planes.empty()) map.Fail("planes", "expected find, or the path of a file of planes");
  }
  for (const KeepInterval& keep : scan.keep)
    if (!kColumns.contains(keep.column)) scan.format.columns.push_back({keep.column, Dimension::kNone, true});
  return scan;
}

bool SamePoints(const ScanDeclaration& a, const ScanDeclaration& b) {
  return a.format.path.lexically_normal() == b.format.path.lexically_normal() && a.format.lines == b.format.lines &&
         a.keep == b.keep && a.planes == b.planes && a.format.text.where == b.format.text.where &&
         a.format.ros.topic == b.format.ros.topic;
}

bool IsKnown(const char* name, const Dataset& dataset) {
  return std::any_of(dataset.parameters.begin(), dataset.parameters.end(),
                     [&](const ParameterSetting& each) { return each.name == name && each.role != "estimate"; });
}

GridBox ReadSearch(YamlMap top, const Units& units) {
  YamlMap search = top.Map("search");
  GridBox box;
  const std::array<double, 2> m = search.Interval("M"), n = search.Interval("N");
  for (size_t k = 0; k < 2; ++k) {
    (k == 0 ? box.lower[0] : box.upper[0]) = m[k] * units.length_in_mm;
    (k == 0 ? box.lower[1] : box.upper[1]) = n[k] * units.length_in_mm;
  }
  for (size_t k = 0; k < 2; ++k)
    if (std::max(std::abs(box.lower[k]), std::abs(box.upper[k])) > kImplausibleOffset_mm)
      search.Fail(k == 0 ? "M" : "N", fmt::format("that is {:.3g} m, expected less than 20 m; is units: length: right?",
                                                  box.upper[k] / 1000));
  box.step = search.Number("step") * units.length_in_mm;
  if (!(box.step > 0)) {
    search.Fail("step", "expected a step greater than zero");
    box.step = 1;
  }
  double nodes = 1;
  for (size_t k = 0; k < 2; ++k) nodes *= std::floor((box.upper[k] - box.lower[k]) / box.step) + 1;
  if (nodes > kMostNodesDeclared)
    search.Fail("step", fmt::format("that makes {:.3g} nodes, expected at most 1e9; use a larger step", nodes));
  return box;
}

Result<void> SetParameters(const Dataset& dataset, Model* model) {
  const std::span<Quantity> quantities(&model->quantity(0), model->quantities().size());
  for (const ParameterSetting& setting : dataset.parameters) {
    const std::string place = "parameters: " + setting.name + ": ";
    if (setting.name == "yaw" || setting.name == "shift_z" || setting.name == "Z")
      return InFile(dataset, place +
                                 "not determined by planes (a turn about the axis or a shift along it moves the whole "
                                 "scene); it is no parameter, remove it");
    SCANCAL_ASSIGN_OR_RETURN(const int index, SetDeclared(setting, dataset, {}, Model::kTiltX, quantities));
    if ((index == Model::kScaleY || index == Model::kScaleZ) && quantities[index].role == Role::kEstimate &&
        quantities[index].u <= 0)
      return InFile(dataset, place +
                                 "not determined by planes (M, N, the distances and the normals absorb a scale "
                                 "exactly); give a prior, {estimate: 0, u: ...}, or consider it");
  }
  return {};
}

constexpr Message<> kOnePlateUnknown{
    "turntable.one_plate_unknown",
    "one_plate is not declared: whether the placements are of one plate, whose form they share, or of several decides "
    "how "
    "much it counts; the worse of both was taken, for each parameter. Declare one_plate: yes or no",
    "one_plate ist nicht angegeben: Ob alle Aufstellungen dieselbe Platte zeigen, deren Form sie teilen, oder mehrere, "
    "entscheidet darüber, wie viel sie zählt; für jeden Parameter wurde das Ungünstigere von beidem genommen. "
    "one_plate: "
    "yes oder no angeben"};

// Peak to valley over rms of a bow, r^2 - 1/3 over [-1, 1]: 1.5 sqrt(5). No mode of FormModesAt has a larger rms for
// its peak to valley; of a surface of all of them the median is 6.3.
constexpr double kPeakToValley = 3.354;

// Those with a quantity of the same name and no rule of their own.
const std::map<std::string, Model::Index> kInfluences = {{"noise_y", Model::kNoiseY},
                                                         {"noise_z", Model::kNoiseZ},
                                                         {"encoder_jitter", Model::kEncoderJitter},
                                                         {"encoder_cos1", Model::kEncoderCos1},
                                                         {"encoder_sin1", Model::kEncoderSin1},
                                                         {"encoder_cos2", Model::kEncoderCos2},
                                                         {"encoder_sin2", Model::kEncoderSin2},
                                                         {"scale_y", Model::kScaleY},
                                                         {"scale_z", Model::kScaleZ},
                                                         {"shear", Model::kShear},
                                                         {"linearity", Model::kLinearity},
                                                         {"linearity_3", Model::kLinearity3},
                                                         {"lens_z2", Model::kLensZ2},
                                                         {"lens_yz", Model::kLensYZ},
                                                         {"lens_yz2", Model::kLensYZ2},
                                                         {"range_offset", Model::kRangeOffset},
                                                         {"range_scale", Model::kRangeScale},
                                                         {"encoder_scale", Model::kEncoderScale},
                                                         {"backlash", Model::kBacklash},
                                                         {"latency", Model::kLatency},
                                                         {"runout", Model::kRunOut},
                                                         {"wobble", Model::kWobble},
                                                         {"drift_sweep", Model::kDriftSweep},
                                                         {"drift", Model::kDrift},
                                                         {"warm_up", Model::kWarmUp},
                                                         {"drift_temperature", Model::kDriftTemperature}};
// What sweeps can tell by themselves.
constexpr std::array kTold = {Model::kLinearity3,  Model::kLensZ2,       Model::kLensYZ,   Model::kLensYZ2,
                              Model::kRangeOffset, Model::kEncoderScale, Model::kBacklash, Model::kLatency,
                              Model::kDriftSweep,  Model::kDrift,        Model::kWarmUp,   Model::kDriftTemperature};

const std::vector<std::string> kOthers = {"line_correlation", "form",        "flatness",
                                          "one_plate",        "temperature", "expansion"};

std::vector<std::string> InfluenceNames() {
  std::vector<std::string> names = kOthers;
  for (const auto& [name, index] : kInfluences) names.push_back(name);
  std::sort(names.begin(), names.end());
  return names;
}

// Sets role and u of the quantities that `influences:` names.
class Influences {
 public:
  Influences(const Dataset& dataset, Model* model, Declaration* declaration)
      : dataset_(dataset), model_(*model), declaration_(*declaration) {}

  Result<void> SetAll() {
    for (const InfluenceSetting& setting : dataset_.influences) SCANCAL_RETURN_IF_ERROR(Set(setting));
    if (!one_plate_ && model_.quantity(Model::kForm).role == Role::kConsider) {
      for (int k = 0; k < kFormModes; ++k) model_.quantity(Model::kForm + k).perhaps_shared = true;
      declaration_.notes.push_back(Say(kOnePlateUnknown));
    }
    return SetExpansion();
  }

 private:
  Error Wrong(const std::string& influence, const std::string& sentence) const {
    return InFile(dataset_, "influences: " + influence + ": " + sentence);
  }

  Result<void> Set(const InfluenceSetting& setting) {
    if (setting.name == "one_plate") return SetOnePlate(setting);
    if (setting.role == "yes" || setting.role == "no")
      return Wrong(setting.name, "found " + setting.role + ", expected a standard uncertainty");
    if (setting.name == "line_correlation") return SetLineCorrelation(setting);
    if (setting.name == "form" || setting.name == "flatness") return SetForm(setting);
    if (setting.name == "temperature" || setting.name == "expansion") return KeepForExpansion(setting);
    const auto found = kInfluences.find(setting.name);
    if (found == kInfluences.end())
      return Wrong(setting.name, "unknown influence" + Suggestion(setting.name, InfluenceNames()));
    return SetQuantity(setting, found->second);
  }

  Result<void> SetQuantity(const InfluenceSetting& setting, Model::Index index) {
    Quantity& quantity = model_.quantity(index);
    const bool random = quantity.scope == Scope::kView || quantity.scope == Scope::kPoint;
    if (!random && quantity.role != Role::kHold)
      return Wrong(setting.name, "declared twice, here and under parameters");
    const bool told_alone = std::find(kTold.begin(), kTold.end(), index) != kTold.end();
    if (!random && !told_alone && setting.role == "estimate" && setting.u == 0)
      return Wrong(setting.name, "not determined by planes, expected its standard uncertainty in place of estimate");
    if (random && setting.role == "estimate" && setting.u > 0)
      return Wrong(setting.name, "its variance is estimated without a prior, expected estimate or a number");
    if (index == Model::kNoiseZ && setting.role == "estimate")
      return Wrong(setting.name,
                   "expected its standard uncertainty in place of estimate: planes cannot tell it from noise_y");
    quantity.u = setting.u * UnitFactor(quantity.unit, dataset_.units);
    SCANCAL_RETURN_IF_ERROR(CheckSize(dataset_, "influences: " + setting.name + ": ", quantity.unit, quantity.u));
    // Of what is random, none at all is a declaration too, which the residuals may contradict.
    const bool told = random && index != Model::kNoiseZ;
    quantity.role = setting.role == "estimate"                               ? Role::kEstimate
                    : setting.role == "consider" && (told || quantity.u > 0) ? Role::kConsider
                                                                             : Role::kHold;
    declaration_.drift_declared |= index == Model::kDrift;
    if (index == Model::kDriftSweep) declaration_.drift_held = quantity.role == Role::kHold;
    for (int k = 1; k < Model::kRunOuts && (index == Model::kRunOut || index == Model::kWobble); ++k) {
      model_.quantity(index + k).u = quantity.u;
      model_.quantity(index + k).role = quantity.role;
    }
    if (index == Model::kNoiseY && quantity.u == 0 && setting.role != "estimate")
      return Wrong(setting.name, "expected more than 0, or estimate: every point has noise");
    return {};
  }

  Result<void> SetForm(const InfluenceSetting& setting) {
    Quantity& first = model_.quantity(Model::kForm);
    if (first.role != Role::kHold) return Wrong(setting.name, "expected form or flatness, not both");
    if (setting.role == "estimate" && setting.u == 0)
      return Wrong(setting.name, "expected its size: form and offset cannot be told apart by the data alone");
    const double u = setting.u * dataset_.units.length_in_mm / (setting.name == "flatness" ? kPeakToValley : 1);
    SCANCAL_RETURN_IF_ERROR(CheckSize(dataset_, "influences: " + setting.name + ": ", Unit::kMm, u));
    for (int k = 0; k < kFormModes && u > 0; ++k) {
      model_.quantity(Model::kForm + k).role = setting.role == "estimate" ? Role::kEstimate : Role::kConsider;
      model_.quantity(Model::kForm + k).u = u;
    }
    return {};
  }

  Result<void> SetOnePlate(const InfluenceSetting& setting) {
    if (setting.role != "yes" && setting.role != "no") return Wrong(setting.name, "expected yes or no");
    one_plate_ = true;
    for (int k = 0; k < kFormModes && setting.role == "yes"; ++k)
      model_.quantity(Model::kForm + k).scope = Scope::kSystem;
    return {};
  }

  Result<void> SetLineCorrelation(const InfluenceSetting& setting) {
    if (setting.role == "estimate") return {};
    if (setting.u > 0 && setting.u < 1)
      return Wrong(setting.name, "expected the integrated correlation length in points, 1 is white noise");
    if (setting.role == "hold") {
      for (const int k : {Model::kLineOffset, Model::kLineSlope}) model_.quantity(k).role = Role::kHold;
    } else {
      declaration_.line_correlation = std::max(1.0, setting.u);
    }
    return {};
  }

  Result<void> KeepForExpansion(const InfluenceSetting& setting) {
    if (setting.role == "estimate") return Wrong(setting.name, "expected a number");
    (setting.name == "temperature" ? temperature_ : expansion_) = setting.u;
    return {};
  }

  // M and N are of a mount at 20 degrees Celsius, known to temperature_ kelvin.
  Result<void> SetExpansion() {
    if (temperature_.has_value() != expansion_.has_value())
      return Wrong(temperature_ ? "temperature" : "expansion",
                   "expected temperature (K) and expansion (1/K) together: u of the mount's temperature and its "
                   "coefficient");
    if (!temperature_ || *temperature_ * *expansion_ == 0) return {};
    Quantity& quantity = model_.quantity(Model::kExpansion);
    quantity.role = Role::kConsider;
    quantity.u = *temperature_ * *expansion_;
    SCANCAL_RETURN_IF_ERROR(CheckSize(dataset_, "influences: temperature, expansion: ", quantity.unit, quantity.u));
    return {};
  }

  const Dataset& dataset_;
  Model& model_;
  Declaration& declaration_;
  std::optional<double> temperature_, expansion_;
  bool one_plate_ = false;  // declared, either way
};

}  // namespace

ScanFormat ScanFormatOf(const std::filesystem::path& path, const Units& units) {
  ScanFormat format;
  format.path = path;
  format.units = units;
  format.one_of = {{"y", "z"}, {"bearing", "range"}};
  for (const auto& [name, dimension] : kColumns) format.columns.push_back({name, dimension, name == "angle"});
  return format;
}

void ReadScanFormat(const YamlMap& map, const std::filesystem::path& folder, ScanFormat* format) {
  if (auto layout = ReadLayout(map)) format->layout = std::move(layout);
  ReadFormat(map, folder, format);
}

Result<Declaration> Declare(const Dataset& dataset, Model* model, bool searches) {
  Declaration result;
  result.dataset = dataset;
  YamlMap top = dataset.yaml;
  const std::string rotation = top.Text("rotation");
  if (rotation != "clockwise" && rotation != "counterclockwise")
    top.Fail("rotation", "expected clockwise or counterclockwise, seen from +Z of the table");
  result.senses.angle = rotation == "counterclockwise" ? -1 : 1;
  if (top.Has("depth")) {
    const std::string depth = top.Text("depth");
    if (depth != "away" && depth != "towards")
      top.Fail("depth", "expected away or towards: which way the sensor's depth grows");
    result.senses.depth = depth == "towards" ? -1 : 1;
    result.senses.depth_declared = true;
  }
  if (top.Has("search") || (searches && !(IsKnown("M", dataset) && IsKnown("N", dataset))))
    result.search = ReadSearch(top, dataset.units);
  else result.searches = false;
  std::set<std::string> names;
  for (YamlMap target : top.Maps("targets")) {
    result.scans.push_back(ReadTarget(target, top, dataset));
    const ScanDeclaration& scan = result.scans.back();
    for (size_t k = 0; k + 1 < result.scans.size(); ++k)
      if (SamePoints(result.scans[k], scan))
        target.Fail("scan",
                    "expected other points than those of target " + result.scans[k].name + ", which has the same");
    if (!names.insert(scan.name).second) target.Fail("name", "expected a name that no other target has");
  }
  if (result.scans.empty()) top.Fail("targets", "expected at least one target");
  SCANCAL_RETURN_IF_ERROR(top.Finish());
  SCANCAL_RETURN_IF_ERROR(SetParameters(dataset, model));
  SCANCAL_RETURN_IF_ERROR(Influences(dataset, model, &result).SetAll());
  return result;
}

}  // namespace scancal::turntable
