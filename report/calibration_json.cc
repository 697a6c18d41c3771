#include "report/calibration_json.h"
#include <cmath>
#include <set>
#include "solver/uncertainty/gum.h"

namespace scancal {
namespace {

// JSON has no infinity: what is not finite is null.
Json Number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

// {"columns": [...], "units": [...], "rows": [[...], ...]}, and "names" of the rows if they have any.
Json ToJson(const NumberTable& table) {
  Json units = Json::array(), rows = Json::array();
  for (const Unit unit : table.units) units.push_back(Name(unit));
  for (const std::vector<double>& row : table.rows) {
    Json numbers = Json::array();
    for (const double number : row) numbers.push_back(Number(number));
    rows.push_back(std::move(numbers));
  }
  Json json = {{"columns", table.columns}, {"units", units}, {"rows", rows}};
  if (!table.names.empty()) json["names"] = table.names;
  return json;
}

Json ToJson(const NumberTables& tables) {
  Json json = Json::object();
  for (const auto& [name, table] : tables) json[name] = ToJson(table);
  return json;
}

// {"targets": [{"name": ..., tables by name}]}; empty if no target has a scene.
Json SceneJson(const std::vector<TargetSummary>& targets) {
  Json list = Json::array();
  for (const TargetSummary& target : targets) {
    if (target.scene.empty()) continue;
    list.push_back({{"name", target.name}});
    list.back().update(ToJson(target.scene));
  }
  return list.empty() ? Json::object() : Json{{"targets", list}};
}

// [{"method", "note", "cells": [{"column", "value", "u"}]}], without computing times: they are never the same.
Json CompareJson(const Comparison& comparison) {
  Json list = Json::array();
  for (const ComparisonRow& row : comparison.rows) {
    Json cells = Json::array();
    for (size_t k = 0; k < row.cells.size(); ++k) {
      const ComparisonCell& cell = row.cells[k];
      if (comparison.columns[k].is_time) continue;
      cells.push_back({{"column", comparison.columns[k].name},
                       {"value", cell.value ? Number(*cell.value) : Json(nullptr)},
                       {"u", cell.u > 0 ? Number(cell.u) : Json(nullptr)}});
    }
    list.push_back({{"method", row.method}, {"note", row.note}, {"cells", cells}});
  }
  return list;
}

Json Whole(double count) { return static_cast<int64_t>(count); }

Json ParameterJson(const Parameter& p) {
  Json json = {
      {"name", p.name}, {"unit", Name(p.unit)}, {"role", Name(p.role)}, {"value", Number(p.value)}, {"u", Number(p.u)}};
  if (p.nominal) json["nominal"] = Number(*p.nominal);
  if (p.role != Role::kEstimate) return json;
  if (p.prior_u > 0) json["prior"] = Number(p.prior);
  if (p.prior_u > 0) json["prior_u"] = Number(p.prior_u);
  json["k"] = Number(p.k);
  json["U"] = Number(p.U);
  json["dof"] = Number(p.dof);
  json["u_naive"] = Number(p.u_naive);
  json["u_clustered"] = Number(p.u_clustered);
  json["u_jackknife"] = p.u_jackknife > 0 ? Number(p.u_jackknife) : Json(nullptr);
  json["u_bootstrap"] = p.u_bootstrap > 0 ? Number(p.u_bootstrap) : Json(nullptr);
  return json;
}

Json TargetJson(const TargetSummary& target) {
  double set_aside = 0;
  Json reasons = Json::object();
  for (const auto& [reason, count] : target.set_aside) {
    set_aside += count;
    reasons[reason] = Whole(count);
  }
  Json json = {{"name", target.name},
               {"points", Whole(target.points)},
               {"missing", Whole(target.missing)},
               {"set_aside", Whole(set_aside)},
               {"set_aside_reasons", reasons}};
  for (const auto& [name, values] : target.geometry) json[name] = values.size() == 1 ? Json(values[0]) : Json(values);
  json["rms"] = Number(target.rms);
  return json;
}

Json ResidualsJson(const TargetSummary& target) {
  const ViewResiduals& r = target.residuals;
  Json json = {{"name", target.name}, {"lags", r.lags}, {"correlation", r.correlation}};
  json["correlation_length"] = r.correlation_length > 0 ? Json(r.correlation_length) : Json(nullptr);
  json["correlation_dies_out"] = r.dies_out;
  json["sigma"] = r.sigma;
  json["histogram"] = {
      {"from", -r.histogram_limit}, {"to", r.histogram_limit}, {"unit", "sigma"}, {"counts", Json::array()}};
  for (const double count : r.histogram) json["histogram"]["counts"].push_back(Whole(count));
  json["histogram"]["below"] = Whole(r.below);
  json["histogram"]["above"] = Whole(r.above);
  json.update(ToJson(target.residual_tables));
  return json;
}

Json ResidualsJson(const Calibration& calibration) {
  Json json = {{"targets", Json::array()}};
  for (const TargetSummary& target : calibration.targets) json["targets"].push_back(ResidualsJson(target));
  return json;
}

Json ByParameter(const std::vector<std::string>& names, const std::vector<double>& values) {
  Json json = Json::object();
  for (size_t k = 0; k < values.size(); ++k) json[names[k]] = Number(values[k]);
  return json;
}

Json MisfitsJson(const Calibration& calibration) {
  Json list = Json::array();
  for (const MisfitTest& misfit : calibration.misfits)
    list.push_back({{"source", misfit.source},
                    {"considered", misfit.considered},
                    {"size", Number(misfit.size)},
                    {"unit", Name(misfit.unit)},
                    {"F", Number(misfit.F)},
                    {"dof1", Number(misfit.dof1)},
                    {"dof2", Number(misfit.dof2)},
                    {"p", Number(misfit.p)},
                    {"moves", ByParameter(calibration.estimated, misfit.moves)}});
  return list;
}

Json CorrelationJson(const Eigen::MatrixXd& covariance) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < covariance.cols(); ++j)
      row.push_back(i == j ? Json(1) : Number(covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j))));
    rows.push_back(row);
  }
  return rows;
}

Json BudgetJson(const Calibration& calibration) {
  Json lines = Json::array();
  for (const BudgetLine& line : calibration.budget)
    lines.push_back({{"source", line.source},
                     {"type", std::string(1, line.type)},
                     {"value", Number(line.u)},
                     {"unit", Name(line.unit)},
                     {"sensitivity", ByParameter(calibration.estimated, line.sensitivity)},
                     {"u", ByParameter(calibration.estimated, line.contribution)},
                     {"share", ByParameter(calibration.estimated, line.share)},
                     {"dof", Number(line.dof)}});
  return lines;
}

Json FrameJson(const Eigen::Matrix4d& frame) {
  Json rows = Json::array();
  for (int i = 0; i < 4; ++i) rows.push_back({frame(i, 0), frame(i, 1), frame(i, 2), frame(i, 3)});
  return rows;
}

Json ErrorsJson(const std::vector<double>& errors) {
  const ErrorSize size = SizeOfErrors(errors);
  return {{"max", size.max}, {"mean", size.mean}, {"errors", errors}};
}

Json KnownJson(const std::vector<double>& u) {  // 0 is not known
  Json json = Json::array();
  for (const double each : u) json.push_back(each > 0 ? Json(each) : Json(nullptr));
  return json;
}

// Models without such a check or frames have no such keys.
void AddCheckAndFrames(const Calibration& c, Json* json) {
  for (const auto& [name, frame] : c.frames) (*json)[name] = FrameJson(frame);
  if (c.check.after.empty()) return;
  (*json)["check"] = {{"before", ErrorsJson(c.check.before)},
                      {"after", ErrorsJson(c.check.after)},
                      {"names", c.check.names},
                      {"pairs", c.check.after.size()}};
  if (!c.check.u.empty()) (*json)["check"]["u"] = KnownJson(c.check.u);
}

Json InfluencesJson(const Calibration& calibration) {
  Json list = Json::array();
  for (const Influence& influence : calibration.influences)
    list.push_back({{"source", influence.source},
                    {"role", Name(influence.role)},
                    {"u", Number(influence.u)},
                    {"unit", Name(influence.unit)},
                    {"scope", Name(influence.scope)}});
  return list;
}

Json JackknifeJson(const Calibration& calibration) {
  Json list = Json::array();
  for (size_t t = 0; t < calibration.jackknife.size(); ++t)
    list.push_back({{"without", calibration.targets[t].name},
                    {"value", ByParameter(calibration.estimated, calibration.jackknife[t])}});
  return list;
}

Json MonteCarloJson(const MonteCarloSummary& summary) {
  if (summary.trials == 0) return Json::object();
  Json json = {{"trials", static_cast<int64_t>(summary.trials)},
               {"failed", static_cast<int64_t>(summary.failed)},
               {"seed", summary.seed},
               {"digits", summary.digits},
               {"stable", summary.stable},
               {"parameters", Json::array()}};
  for (const MonteCarloParameter& p : summary.parameters) {
    Json each = {{"name", p.name}};
    for (const auto& [key, number] : kMonteCarloNumbers) each[key] = Number(p.*number);
    each["verdict"] = p.verdict;
    each["histogram"] = {{"edges", p.edges}, {"counts", Json::array()}};
    for (const double count : p.counts) each["histogram"]["counts"].push_back(static_cast<int64_t>(count));
    json["parameters"].push_back(std::move(each));
  }
  return json;
}

// What a reader of another language reads in place of the English: each sentence once.
Json MessagesJson(const Calibration& c, const Comparison& comparison) {
  Json list = Json::array();
  std::set<std::string> said;
  const auto add = [&](const Sentence& sentence) {
    if (!sentence.id.empty() && said.insert(sentence.english).second)
      list.push_back({{"id", sentence.id}, {"en", sentence.english}, {"de", sentence.german}});
  };
  for (const auto* sentences : {&c.unreliable, &c.warnings, &c.notes, &c.check.names})
    for (const Sentence& sentence : *sentences) add(sentence);
  for (const BudgetLine& line : c.budget) add(line.source);
  for (const ComparisonRow& row : comparison.rows) {
    add(row.method);
    add(row.note);
  }
  return list;
}

}  // namespace

Json FiguresToJson(const Calibration& c, const Comparison& comparison) {
  return {{"compare", CompareJson(comparison)},
          {"surface", ToJson(c.surface)},
          {"residuals", ResidualsJson(c)},
          {"messages", MessagesJson(c, comparison)}};
}

bool HoldsFigures(const Json& file) { return file.contains("compare") && !file["compare"].empty(); }

Json ToJson(const Calibration& c, const Enclosures& with) {
  Json json = {{"scancal", kFormatVersion}, {"model", c.model}, {"name", c.name}, {"residual", c.residual}};
  json["status"] = c.ok() ? "ok" : "unreliable";
  json["unreliable"] = c.unreliable;
  json["warnings"] = c.warnings;
  json["notes"] = c.notes;
  json["weights"] = c.equal_weights ? "equal" : "estimated";
  json["messages"] = MessagesJson(c, {});
  json["parameters"] = Json::array();
  for (const Parameter& parameter : c.parameters) json["parameters"].push_back(ParameterJson(parameter));
  json["determined"] = Json::object();
  for (const Parameter& parameter : c.parameters) json["determined"][parameter.name] = parameter.determined;
  AddCheckAndFrames(c, &json);
  json["covariance"] = Json::array();
  for (Eigen::Index i = 0; i < c.covariance.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < c.covariance.cols(); ++j) row.push_back(Number(c.covariance(i, j)));
    json["covariance"].push_back(row);
  }
  json["covariance_of"] = c.estimated;
  json["correlation"] = CorrelationJson(c.covariance);
  json["coverage_probability"] = kCoverage;
  json["joint"] = {{"k", Number(c.joint.k)}, {"dof", Number(c.joint.dof)}};
  json["grid"] = {{"step", c.grid.step}, {"S", Number(c.grid.S)}, {"nodes", Whole(c.grid.nodes)}};
  for (size_t k = 0; k < c.grid.at.size(); ++k) json["grid"][c.grid.names[k]] = c.grid.at[k];
  json["targets"] = Json::array();
  for (const TargetSummary& target : c.targets) json["targets"].push_back(TargetJson(target));
  json["sigma"] = Number(c.sigma);
  json["pure_error_sigma"] = Number(c.lack_of_fit.pure_error_sigma);
  json["lack_of_fit"] = Json::object();
  if (c.lack_of_fit.dof1 > 0)
    json["lack_of_fit"] = {
        {"F", c.lack_of_fit.F}, {"dof1", c.lack_of_fit.dof1}, {"dof2", c.lack_of_fit.dof2}, {"p", c.lack_of_fit.p}};
  json["condition"] = Number(c.condition);
  json["weakest"] = c.weakest;
  json["neighbours"] = Number(c.neighbours);
  if (c.neighbour_noise > 0) json["neighbour_noise"] = Number(c.neighbour_noise);
  json["misfits"] = MisfitsJson(c);
  json["budget"] = BudgetJson(c);
  json["influences"] = InfluencesJson(c);
  json["compare"] = Json::array();
  json["surface"] = ToJson(c.surface);
  json["jackknife"] = JackknifeJson(c);
  json["montecarlo"] = MonteCarloJson(c.monte_carlo);
  json["residuals"] = ResidualsJson(c);
  json["scene"] = SceneJson(c.targets);
  json["volume"] = c.volume.rows.empty() ? Json::object() : ToJson(c.volume);
  json["data"] = with.data;
  json["converged"] = c.converged;
  json["iterations"] = c.iterations;
  json["inputs"] = Json::array();
  for (const HashedFile& input : c.inputs) json["inputs"].push_back({{"file", input.file}, {"sha256", input.sha256}});
  json["command"] = c.command;
  json["version"] = c.version;
  if (!with.certificate.is_null()) json["certificate"] = with.certificate;
  return json;
}

}  // namespace scancal
