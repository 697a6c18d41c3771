#include "report/uncertainty_text.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include "report/text_table.h"

namespace scancal {
namespace {

constexpr size_t kFewParameters = 4;  // that fit side by side
constexpr size_t kFewTargets = 12;

std::string Shown(double number) { return number > 0 ? Significant(number, 2) : "-"; }

// Degrees of freedom beyond counting: k no longer depends on them.
std::string Dof(double dof) { return dof < 1e6 ? Count(std::floor(dof)) : "infinite"; }

std::string Percent(double share) { return share < 0.0005 ? "0.0" : fmt::format("{:.1f}", 100 * share); }

std::string Sources(const Calibration& c) {
  TextTable table({"u comes from", "type", "value", "unit", "dof"});
  for (const BudgetLine& line : c.budget)
    table.Add({line.source, std::string(1, line.type), Significant(line.u, 2), Name(line.unit), Dof(line.dof)});
  return table.Text();
}

std::string Shares(const Calibration& c) {
  std::vector<std::string> header = {"share of u^2/%"};
  for (const BudgetLine& line : c.budget) header.push_back(line.source);
  header.insert(header.end(), {"u", "unit", "known by"});
  TextTable table(header);
  for (size_t k = 0; k < c.estimated.size(); ++k) {
    const Parameter& p = *c.Find(c.estimated[k]);
    std::vector<std::string> row = {p.name};
    for (const BudgetLine& line : c.budget) row.push_back(Percent(line.share[k]));
    row.insert(row.end(), {Shown(p.u), Name(p.unit), p.determined});
    table.Add(row);
  }
  return table.Text();
}

double MoveInU(const Calibration& c, size_t target, size_t parameter) {
  const Parameter& p = *c.Find(c.estimated[parameter]);
  return (c.jackknife[target][parameter] - p.value) / p.u;
}

std::string MovesByParameter(const Calibration& c) {
  std::vector<std::string> header = {"moves by, without"};
  const bool few = c.jackknife.size() <= kFewTargets;
  for (size_t t = 0; few && t < c.jackknife.size(); ++t) header.push_back(c.targets[t].name);
  if (!few) header.insert(header.end(), {"most by", "target"});
  TextTable table(header);
  for (size_t k = 0; k < c.estimated.size(); ++k) {
    std::vector<std::string> row = {c.estimated[k]};
    size_t most = 0;
    for (size_t t = 0; t < c.jackknife.size(); ++t) {
      if (few) row.push_back(fmt::format("{:+.2f} u", MoveInU(c, t, k)));
      if (std::abs(MoveInU(c, t, k)) > std::abs(MoveInU(c, most, k))) most = t;
    }
    if (!few) row.insert(row.end(), {fmt::format("{:+.2f} u", MoveInU(c, most, k)), c.targets[most].name});
    table.Add(row);
  }
  return table.Text() + "\n";
}

}  // namespace

std::string ParametersText(const Calibration& c) {
  TextTable table(
      {"", "value", "unit", "u", "U (95 %)", "k", "dof", "u naive", "u clustered", "u jackknife", "u bootstrap"});
  std::map<std::string, int> considered;  // source -> parameters that are nominally zero and share it
  for (const Parameter& p : c.parameters)
    if (p.role == Role::kConsider && p.value == 0 && p.source != p.name) ++considered[p.source];
  for (const Parameter& p : c.parameters) {
    if (p.role == Role::kHold && p.value == 0) continue;
    const auto shared = considered.find(p.source);
    if (p.role == Role::kConsider && p.value == 0 && shared != considered.end()) {
      if (shared->second > 0)
        table.Add({fmt::format("{} ({} quantities)", p.source, shared->second), Concise(0, p.u), Name(p.unit),
                   Shown(p.u), "", "", "", "", "", "", "considered"});
      shared->second = 0;
      continue;
    }
    if (p.role != Role::kEstimate) {
      table.Add({p.name, Concise(p.value, p.u), Name(p.unit), Shown(p.u), "", "", "", "", "", "",
                 p.role == Role::kHold ? "held" : "considered"});
      continue;
    }
    table.Add({p.name, Concise(p.value, p.u), Name(p.unit), Shown(p.u), Shown(p.U), Significant(p.k, 3), Dof(p.dof),
               Shown(p.u_naive), Shown(p.u_clustered), Shown(p.u_jackknife), Shown(p.u_bootstrap)});
  }
  return table.Text();
}

std::string LeaveOneOutText(const Calibration& c) {
  if (c.jackknife.empty()) return "";
  if (c.estimated.size() > kFewParameters) return MovesByParameter(c);
  std::vector<std::string> header = {"without target"};
  for (const std::string& name : c.estimated) header.push_back(name + " moves by");
  TextTable table(header);
  for (size_t t = 0; t < c.jackknife.size(); ++t) {
    std::vector<std::string> row = {c.targets[t].name};
    for (size_t k = 0; k < c.estimated.size(); ++k) {
      row.push_back(fmt::format("{:+.2f} u", MoveInU(c, t, k)));
    }
    table.Add(row);
  }
  return table.Text() + "\n";
}

std::string BudgetText(const Calibration& c) {
  if (c.estimated.size() > kFewParameters) return Sources(c) + "\n" + Shares(c);
  std::vector<std::string> header = {"u comes from", "type", "value", "unit", "dof"};
  for (const std::string& name : c.estimated) {
    header.push_back("u(" + name + ")");
    header.push_back("share/%");
  }
  TextTable table(header);
  for (const BudgetLine& line : c.budget) {
    std::vector<std::string> row = {line.source, std::string(1, line.type), Significant(line.u, 2), Name(line.unit),
                                    Dof(line.dof)};
    for (size_t k = 0; k < line.contribution.size(); ++k) {
      row.push_back(Significant(line.contribution[k], 2));
      row.push_back(Percent(line.share[k]));
    }
    table.Add(row);
  }
  std::vector<std::string> sum = {"combined", "", "", "", ""};
  for (const std::string& name : c.estimated) {
    sum.push_back(Significant(c.Find(name)->u, 2));
    sum.push_back("100");
  }
  table.Add(sum);
  return table.Text();
}

}  // namespace scancal
