#include <limits>
#include <optional>
#include "report/calibration_json.h"
#include "solver/dense.h"
#include "solver/uncertainty/gum.h"

namespace scancal {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

const Json& At(const Json& object, const char* key) {
  static const Json nothing;
  return object.is_object() && object.contains(key) ? object[key] : nothing;
}

double NumberAt(const Json& object, const char* key, double otherwise = kNotANumber) {
  const Json& value = At(object, key);
  return value.is_number() ? value.get<double>() : otherwise;
}

std::string TextAt(const Json& object, const char* key) {
  const Json& value = At(object, key);
  return value.is_string() ? value.get<std::string>() : "";
}

template <class Enum>
std::optional<Enum> Named(const std::string& name, std::initializer_list<Enum> all) {
  for (const Enum each : all)
    if (name == Name(each)) return each;
  return std::nullopt;
}

std::optional<Unit> UnitNamed(const std::string& name) { return Named(name, {Unit::kMm, Unit::kRad, Unit::kOne}); }

std::optional<std::vector<std::string>> Texts(const Json& list) {
  if (!list.is_array()) return std::nullopt;
  std::vector<std::string> texts;
  for (const Json& each : list) {
    if (!each.is_string()) return std::nullopt;
    texts.push_back(each);
  }
  return texts;
}

// null is not a number; anything else that is none makes the list none.
std::optional<std::vector<double>> Numbers(const Json& list, size_t size) {
  if (!list.is_array() || list.size() != size) return std::nullopt;
  std::vector<double> numbers;
  for (const Json& each : list) {
    if (!each.is_number() && !each.is_null()) return std::nullopt;
    numbers.push_back(each.is_null() ? kNotANumber : each.get<double>());
  }
  return numbers;
}

// {"M": 0.1, "N": 0.2}: all of the names, or none.
std::optional<std::vector<double>> ByName(const Json& object, const std::vector<std::string>& names) {
  if (!object.is_object()) return std::nullopt;
  std::vector<double> numbers;
  if (object.empty()) return numbers;
  for (const std::string& name : names) {
    if (!object.contains(name)) return std::nullopt;
    numbers.push_back(NumberAt(object, name.c_str()));
  }
  return numbers;
}

void ReadParameter(const Json& json, Parameter* parameter) {
  parameter->unit = UnitNamed(TextAt(json, "unit")).value_or(Unit::kOne);
  parameter->role = Named(TextAt(json, "role"), {Role::kEstimate, Role::kConsider, Role::kHold}).value_or(Role::kHold);
  parameter->u = NumberAt(json, "u", 0);
  parameter->k = NumberAt(json, "k", 0);
  parameter->U = NumberAt(json, "U", 0);
  parameter->dof = NumberAt(json, "dof", kInfinity);
}

bool ReadCovariance(const Json& json, Calibration* calibration) {
  const auto names = Texts(At(json, "covariance_of"));
  const Json& matrix = At(json, "covariance");
  if (!names || !matrix.is_array() || matrix.size() != names->size()) return false;
  const auto n = std::ssize(*names);
  calibration->covariance.resize(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto row = Numbers(matrix[static_cast<size_t>(i)], names->size());
    if (!row || !calibration->Find((*names)[i])) return false;
    calibration->covariance.row(i) = Eigen::Map<const Eigen::RowVectorXd>(row->data(), n);
  }
  calibration->estimated = *names;
  return true;
}

// Symmetric, finite, and the covariance of something: a damaged one would make uncertainties look small.
bool IsCovariance(const Eigen::MatrixXd& matrix) {
  constexpr double kRounding = 1e-9;
  if (!matrix.allFinite() || (matrix.diagonal().array() < 0).any()) return false;
  const Eigen::VectorXd u = matrix.diagonal().cwiseSqrt();
  const Eigen::VectorXd scale = (u.array() > 0).select(u.cwiseInverse(), 0.0);
  const Eigen::MatrixXd correlation = scale.asDiagonal() * matrix * scale.asDiagonal();
  if ((correlation - correlation.transpose()).cwiseAbs().maxCoeff() > kRounding) return false;
  return EigenOf(correlation).values[0] > -kRounding;
}

bool ReadBudget(const Json& json, Calibration* calibration) {
  const Json& budget = At(json, "budget");
  if (!budget.is_array()) return false;
  for (const Json& each : budget) {
    BudgetLine& line = calibration->budget.emplace_back();
    line.source.english = TextAt(each, "source");
    line.type = TextAt(each, "type") == "B" ? 'B' : 'A';
    line.unit = UnitNamed(TextAt(each, "unit")).value_or(Unit::kOne);
    line.u = NumberAt(each, "value");
    line.dof = NumberAt(each, "dof", kInfinity);
    for (const auto& [key, to] :
         {std::pair{"sensitivity", &line.sensitivity}, {"u", &line.contribution}, {"share", &line.share}}) {
      const auto numbers = ByName(At(each, key), calibration->estimated);
      if (!numbers) return false;
      *to = *numbers;
    }
    if (line.source.empty()) return false;
  }
  return true;
}

bool ReadVolume(const Json& json, NumberTable* volume) {
  const auto columns = Texts(At(json, "columns")), units = Texts(At(json, "units"));
  const Json& rows = At(json, "rows");
  if (!columns || !units || units->size() != columns->size() || !rows.is_array()) return false;
  volume->columns = *columns;
  for (const std::string& name : *units) volume->units.push_back(UnitNamed(name).value_or(Unit::kOne));
  for (const Json& each : rows) {
    const auto row = Numbers(each, columns->size());
    if (!row) return false;
    volume->rows.push_back(*row);
  }
  return true;
}

// The parameters' names and values are in `calibration`.
Result<void> ReadUncertainties(const Json& json, const std::string& file, Calibration* calibration) {
  const auto expected = [&](const std::string& what) {
    return Error{file + ": expected " + what + "; is it a calibration.json?"};
  };
  for (size_t k = 0; k < calibration->parameters.size(); ++k)
    ReadParameter(json["parameters"][k], &calibration->parameters[k]);
  if (json.contains("covariance_of") && !ReadCovariance(json, calibration))
    return expected("a square \"covariance\" of the parameters in \"covariance_of\"");
  const bool sound = calibration->covariance.size() == 0 || !calibration->ok() || IsCovariance(calibration->covariance);
  if (!sound) return expected("a symmetric \"covariance\" of finite numbers without negative eigenvalues");
  for (const Parameter& parameter : calibration->parameters)
    if (parameter.role == Role::kEstimate && (parameter.u < 0 || parameter.U < 0 || !(parameter.dof > 0)))
      return expected("u and U not below 0 and dof above 0 of " + parameter.name);
  if (json.contains("budget") && !ReadBudget(json, calibration))
    return expected("a list of sources with numbers for the estimated parameters as \"budget\"");
  if (json.contains("volume") && !json["volume"].empty() && !ReadVolume(json["volume"], &calibration->volume))
    return expected("a table with columns, units and rows as \"volume\"");
  return {};
}

// A number that is not finite comes back as not a number.
Result<MonteCarloSummary> MonteCarloFromJson(const Json& json, const std::string& file) {
  MonteCarloSummary summary;
  if (json.empty()) return summary;
  try {
    summary.trials = json.at("trials");
    summary.failed = json.at("failed");
    summary.seed = json.at("seed");
    summary.digits = json.at("digits");
    summary.stable = json.at("stable");
    for (const Json& each : json.at("parameters")) {
      MonteCarloParameter& p = summary.parameters.emplace_back();
      p.name = each.at("name");
      for (const auto& [key, number] : kMonteCarloNumbers)
        p.*number = each.at(key).is_null() ? kNotANumber : each.at(key).get<double>();
      p.verdict = each.at("verdict");
      p.edges = each.at("histogram").at("edges").get<std::vector<double>>();
      p.counts = each.at("histogram").at("counts").get<std::vector<double>>();
    }
  } catch (const Json::exception&) {
    return Error{file + ": expected \"montecarlo\" as scancal montecarlo writes it; is it a calibration.json?"};
  }
  return summary;
}

}  // namespace

Result<Calibration> CalibrationFromJson(const Json& json, const std::string& file) {
  const auto expected = [&](const std::string& what) {
    return Error{file + ": expected " + what + "; is it a calibration.json?"};
  };
  if (!json.is_object() || !json.contains("scancal") || !json["scancal"].is_number())
    return expected("a format version, \"scancal\": 1");
  if (json["scancal"] != kFormatVersion) return expected("format version 1, found " + json["scancal"].dump());
  if (!json.contains("model") || !json["model"].is_string()) return expected("\"model\"");
  if (!json.contains("parameters") || !json["parameters"].is_array()) return expected("a list of \"parameters\"");
  Calibration result;
  result.model = json["model"];
  result.residual = TextAt(json, "residual");
  result.equal_weights = TextAt(json, "weights") == "equal";
  if (!json.contains("status") || !json["status"].is_string()) return expected("\"status\"");
  if (json["status"] != "ok") result.unreliable.push_back({"the calibration says so of itself"});
  for (const Json& each : json["parameters"]) {
    if (!each.is_object() || !each.contains("name") || !each["name"].is_string())
      return expected("a name for every parameter");
    const std::string name = each["name"];
    if (!each.contains("value") || !each["value"].is_number()) return expected("a number as \"value\" of " + name);
    Parameter& parameter = result.parameters.emplace_back();
    parameter.name = name;
    parameter.value = each["value"];
  }
  if (json.contains("inputs") && json["inputs"].is_array())
    for (const Json& each : json["inputs"])
      if (each.is_object() && each.contains("file") && each["file"].is_string() && each.contains("sha256") &&
          each["sha256"].is_string())
        result.inputs.push_back({each["file"], each["sha256"]});
  if (json.contains("montecarlo")) {
    SCANCAL_ASSIGN_OR_RETURN(result.monte_carlo, MonteCarloFromJson(json["montecarlo"], file));
  }
  SCANCAL_RETURN_IF_ERROR(ReadUncertainties(json, file, &result));
  return result;
}

Result<Calibration> ReadCalibration(const std::filesystem::path& file) {
  SCANCAL_ASSIGN_OR_RETURN(const Json json, ReadJson(file));
  return CalibrationFromJson(json, file.string());
}

}  // namespace scancal
