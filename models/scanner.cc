#include "models/scanner.h"
#include <fmt/format.h>
#include "io/json_file.h"
#include "io/message.h"
#include "io/progress.h"

namespace scancal {

Result<Comparison> Scanner::Compare(const CompareChoice&) const {
  return Error{"compare: the model " + dataset().model + " has no other methods to be compared with"};
}

Result<void> Scanner::WriteSurface(const std::filesystem::path&) const {
  return Error{"surface: the model " + dataset().model + " searches no grid, expected a data set of one that does"};
}

Result<Propagation> ScannerKind::Propagate(const Calibration& calibration, const PointRequest& points,
                                           bool distances) const {
  if (propagate) return propagate(calibration, points, distances);
  return Error{std::string("propagate: the model ") + name +
               " gives no uncertainty of single points, expected a calibration of one that does"};
}

Json ToJson(const Sentence& sentence) {
  if (sentence.id.empty()) return sentence.english;
  return {{"id", sentence.id}, {"en", sentence.english}, {"de", sentence.german}};
}

std::optional<Sentence> SentenceFromJson(const Json& json) {
  if (json.is_string()) return Sentence{json.get<std::string>()};
  if (!json.is_object()) return std::nullopt;
  for (const char* key : {"id", "en", "de"})
    if (!json.contains(key) || !json[key].is_string()) return std::nullopt;
  return Sentence{json["en"], json["de"], json["id"]};
}

Error InFile(const Dataset& dataset, const std::string& sentence) { return {dataset.file.string() + ": " + sentence}; }

double UnitFactor(Unit unit, const Units& units) {
  return units.Of(unit == Unit::kMm ? Dimension::kLength : unit == Unit::kRad ? Dimension::kAngle : Dimension::kNone);
}

Result<void> CheckSize(const Dataset& dataset, const std::string& place, Unit unit, double u) {
  constexpr double kLargest_mm = 20'000, kLargest_rad = 360 * kDegree, kLargestRatio = 1;
  const double largest = unit == Unit::kMm ? kLargest_mm : unit == Unit::kRad ? kLargest_rad : kLargestRatio;
  if (u <= largest) return {};
  return InFile(dataset, place + fmt::format("found a standard uncertainty of {:.3g} {}, expected at most {:g}", u,
                                             unit == Unit::kOne ? "of the whole" : Name(unit), largest));
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
  SCANCAL_RETURN_IF_ERROR(CheckSize(dataset, place, quantity.unit, quantity.u));
  if (index < without_nominal && quantity.role != Role::kEstimate && !setting.value)
    return InFile(dataset, place + setting.role + ": expected its value, for example {" + setting.role + ": 123}");
  return index;
}

std::string Opening(const Dataset& dataset, const std::string& kind) {
  return fmt::format("{}: {}, lengths in {}, angles in {}",
                     dataset.name.empty() ? dataset.file.parent_path().filename().string() : dataset.name, kind,
                     dataset.units.length, dataset.units.angle);
}

Result<void> CheckOnlyResidual(const RefineChoice& choice, const std::string& name) {
  if (choice.residual.empty() || choice.residual == "depth" || choice.residual == name) return {};
  return Error{"residual: found \"" + choice.residual + "\", but the only one of this model is \"" + name + "\""};
}

Result<void> CheckMonteCarlo(const RefineChoice& choice, bool weighted) {
  if (weighted || choice.monte_carlo.trials == 0) return {};
  return Error{"montecarlo: found equal weights, expected estimated ones: only they say how large all noise is"};
}

Result<void> CheckDetermined(const Observability& seen, const UndeterminedWords& words) {
  if (!seen.undetermined_targets.empty())
    return Error{words.target + (" " + Listed(seen.undetermined_targets)) + ": " + words.of_target};
  if (!seen.undetermined.empty())
    return Error{Listed(seen.undetermined) + ": not determined by " + words.by + "; hold " +
                 (seen.undetermined.size() == 1 ? "it" : "one of them") + " or give a prior, {estimate: 0, u: ...}"};
  return {};
}

double Stopwatch::Seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
}

Calibration Conclude(const Dataset& dataset, const Refined& refined, const MonteCarloChoice& monte_carlo) {
  Calibration result = Summarize(refined.solution, refined.pure_error);
  Progress progress("Monte Carlo");
  AddResampling(
      refined.solution, monte_carlo, [&](double done) { progress.Show(done); }, &result);
  result.model = dataset.model;
  result.name = dataset.name;
  result.residual = refined.residual;
  result.equal_weights = !refined.solution.variances;
  result.seconds = refined.seconds;
  result.warnings.insert(result.warnings.begin(), refined.warnings.begin(), refined.warnings.end());
  return result;
}

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
