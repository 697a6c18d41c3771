#include "report/montecarlo_json.h"
#include <cmath>
#include <limits>
#include <utility>

namespace scancal {
namespace {

constexpr std::pair<const char*, double MonteCarloParameter::*> kNumbers[] = {
    {"mean", &MonteCarloParameter::mean},
    {"u", &MonteCarloParameter::deviation},
    {"low", &MonteCarloParameter::low},
    {"high", &MonteCarloParameter::high},
    {"gum_low", &MonteCarloParameter::gum_low},
    {"gum_high", &MonteCarloParameter::gum_high},
    {"tolerance", &MonteCarloParameter::tolerance}};

}  // namespace

Json ToJson(const MonteCarloSummary& summary) {
  if (summary.trials == 0) return Json::object();
  Json json = {{"trials", static_cast<int64_t>(summary.trials)},
               {"failed", static_cast<int64_t>(summary.failed)},
               {"seed", summary.seed},
               {"digits", summary.digits},
               {"stable", summary.stable},
               {"parameters", Json::array()}};
  for (const MonteCarloParameter& p : summary.parameters) {
    Json each = {{"name", p.name}};
    for (const auto& [key, number] : kNumbers) each[key] = std::isfinite(p.*number) ? Json(p.*number) : Json(nullptr);
    each["verdict"] = p.verdict;
    each["histogram"] = {{"edges", p.edges}, {"counts", Json::array()}};
    for (const double count : p.counts) each["histogram"]["counts"].push_back(static_cast<int64_t>(count));
    json["parameters"].push_back(std::move(each));
  }
  return json;
}

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
      for (const auto& [key, number] : kNumbers)
        p.*number = each.at(key).is_null() ? std::numeric_limits<double>::quiet_NaN() : each.at(key).get<double>();
      p.verdict = each.at("verdict");
      p.edges = each.at("histogram").at("edges").get<std::vector<double>>();
      p.counts = each.at("histogram").at("counts").get<std::vector<double>>();
    }
  } catch (const Json::exception&) {
    return Error{file + ": expected \"montecarlo\" as scancal montecarlo writes it; is it a calibration.json?"};
  }
  return summary;
}

}  // namespace scancal
