#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include "io/units.h"
#include "report/text.h"

namespace scancal {
namespace {

constexpr size_t kFewParameters = 4;  // that fit side by side
constexpr size_t kFewTargets = 12;
constexpr size_t kFewNames = 6, kMostTargets = 30;
constexpr double kTakesPart = 0.2;  // of a unit vector

std::string Shown(double number) { return number > 0 ? Significant(number, 2) : "-"; }

// Degrees of freedom beyond counting: k no longer depends on them.
std::string Dof(double dof) { return dof < 1e6 ? Count(std::floor(dof)) : "infinite"; }

std::string Percent(double share) { return share < 0.0005 ? "0.0" : fmt::format("{:.1f}", 100 * share); }

std::string Sources(const Calibration& c) {
  TextTable table({"u comes from", "type", "value", "unit", "dof", "share of u^2/%", "most of"});
  for (const BudgetLine& line : c.budget) {
    const auto [least, most] = std::minmax_element(line.share.begin(), line.share.end());
    if (most == line.share.end()) continue;
    table.Add({line.source, std::string(1, line.type), Significant(line.u, 2), Name(line.unit), Dof(line.dof),
               Percent(*least) + " to " + Percent(*most), c.estimated[static_cast<size_t>(most - line.share.begin())]});
  }
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

// "without target 7 a_2 moves most: by -1.84 u".
std::string MostMoved(const Calibration& c) {
  size_t target = 0, parameter = 0;
  for (size_t t = 0; t < c.jackknife.size(); ++t)
    for (size_t k = 0; k < c.estimated.size(); ++k)
      if (std::abs(MoveInU(c, t, k)) > std::abs(MoveInU(c, target, parameter))) target = t, parameter = k;
  return fmt::format("without target {} {} moves most: by {:+.2f} u\n\n", c.targets[target].name,
                     c.estimated[parameter], MoveInU(c, target, parameter));
}

// Value and uncertainties of every parameter that is estimated, considered or held off its nominal value. wide: by
// every estimator of u.
std::string ParametersText(const Calibration& c, bool wide) {
  std::vector<std::string> header = {"", "value", "unit", "u", "U (" + CoverageText() + ")", "k", "dof"};
  if (wide) header.insert(header.end(), {"u naive", "u clustered", "u jackknife", "u bootstrap"});
  else header.emplace_back();
  TextTable table(header);
  const auto add = [&](std::vector<std::string> row, const std::string& remark) {
    row.resize(header.size() - 1);
    row.push_back(remark);
    table.Add(row);
  };
  std::map<std::string, int> considered;  // source -> parameters that are nominally zero and share it
  for (const Parameter& p : c.parameters)
    if (p.role == Role::kConsider && p.value == 0 && p.source != p.name) ++considered[p.source];
  for (const Parameter& p : c.parameters) {
    if (p.role == Role::kHold && p.value == 0) continue;
    const auto shared = considered.find(p.source);
    if (p.role == Role::kConsider && p.value == 0 && shared != considered.end()) {
      if (shared->second > 0)
        add({fmt::format("{} ({} quantities)", p.source, shared->second), Concise(0, p.u), Name(p.unit), Shown(p.u)},
            "considered");
      shared->second = 0;
      continue;
    }
    if (p.role != Role::kEstimate) {
      add({p.name, Concise(p.value, p.u), Name(p.unit), Shown(p.u)}, p.role == Role::kHold ? "held" : "considered");
      continue;
    }
    std::vector<std::string> row = {p.name,     Concise(p.value, p.u), Name(p.unit), Shown(p.u),
                                    Shown(p.U), Significant(p.k, 3),   Dof(p.dof)};
    if (wide) row.insert(row.end(), {Shown(p.u_naive), Shown(p.u_clustered), Shown(p.u_jackknife)});
    add(std::move(row), wide ? Shown(p.u_bootstrap) : "");
  }
  return table.Text();
}

// Which target moves which parameter, in units of its u.
std::string LeaveOneOutText(const Calibration& c, bool wide) {
  if (c.jackknife.empty()) return "";
  if (c.estimated.size() > kFewParameters) return wide ? MovesByParameter(c) : MostMoved(c);
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

// Where u comes from: the budget, and its sum. With many parameters one line for each, the shares across.
std::string BudgetText(const Calibration& c, bool wide) {
  if (c.estimated.size() > kFewParameters) return Sources(c) + (wide ? "\n" + Shares(c) : "");
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

std::string Targets(const Calibration& c) {
  TextTable table({"target", "points", "missing in scan", "set aside", "rms(" + c.residual + ")/mm"});
  std::string reasons;
  for (size_t t = 0; t < c.targets.size(); ++t) {
    const TargetSummary& target = c.targets[t];
    double set_aside = 0;
    for (const auto& [reason, count] : target.set_aside) {
      set_aside += count;
      reasons += "set aside: " + target.name + ": " + Count(count) + " points " + reason + "\n";
    }
    if (t < kMostTargets)
      table.Add(
          {target.name, Count(target.points), Count(target.missing), Count(set_aside), Significant(target.rms, 4)});
  }
  if (c.targets.size() > kMostTargets)
    reasons = "and " + Count(static_cast<double>(c.targets.size() - kMostTargets)) +
              " more targets, all in calibration.json\n" + reasons;
  return table.Text() + reasons;
}

// To the second digit of u, as Concise has it.
std::string Rounded(double value, double u) {
  const std::string concise = Concise(value, u);
  return concise.substr(0, concise.find('('));
}

std::string MonteCarloText(const Calibration& c) {
  const MonteCarloSummary& summary = c.monte_carlo;
  std::string text = "Monte Carlo: " + Count(summary.trials) + " trials, seed " + std::to_string(summary.seed) +
                     "; value +- U validated to " + (summary.digits == 1 ? "one digit" : "two digits") +
                     " of u (JCGM 101, clause 8)\n";
  TextTable table({"", "mean", "unit", "u", "low", "high", "value - U", "value + U", "tolerance", "value +- U"});
  for (const MonteCarloParameter& p : summary.parameters)
    table.Add({p.name, Rounded(p.mean, p.deviation), Name(c.Find(p.name)->unit), Shown(p.deviation),
               Rounded(p.low, p.deviation), Rounded(p.high, p.deviation), Rounded(p.gum_low, p.deviation),
               Rounded(p.gum_high, p.deviation), Shown(p.tolerance), p.verdict});
  text += table.Text();
  if (!summary.stable) text += "the trials were too few for the adaptive procedure of clause 7.9 to end\n";
  return text;
}

// The range of the largest U over the volume, and where it is largest.
std::string VolumeText(const NumberTable& volume) {
  if (volume.rows.empty()) return "";
  const auto by_U = [](const auto& a, const auto& b) { return a.back() < b.back(); };
  const auto [least, most] = std::minmax_element(volume.rows.begin(), volume.rows.end(), by_U);
  const std::string from = Significant(least->back(), 2), to = Significant(most->back(), 2);
  std::string text = "expanded uncertainty of a measured point over the scanned volume: " + from;
  if (from != to) {
    text += " to " + to + " mm, largest at";
    for (size_t k = 0; k < volume.columns.size() && volume.columns[k] != "X"; ++k) {
      const bool angle = volume.units[k] == Unit::kRad;
      text += (k ? ", " : " ") + volume.columns[k] + " = " + Significant(angle ? (*most)[k] / kDegree : (*most)[k], 3) +
              (angle ? " deg" : " mm");
    }
  } else {
    text += " mm throughout";
  }
  return text + "; the noise of a single reading is not in it\n";
}

std::string GridText(const GridMinimum& grid) {
  if (grid.at.empty()) return "";
  std::string text = "grid search: ";
  for (size_t k = 0; k < grid.at.size(); ++k) text += grid.names[k] + " = " + Significant(grid.at[k], 6) + " mm, ";
  return text + "S = " + Significant(grid.S, 4) + " mm (step " + Significant(grid.step, 2) + " mm, " +
         Count(grid.nodes) + " nodes)\n";
}

std::string CheckText(const LengthCheck& check) {
  if (check.after.empty()) return "";
  const auto figures = [](const std::vector<double>& errors) {
    const ErrorSize size = SizeOfErrors(errors);
    return Significant(size.max, 3) + " mm at most, " + Significant(size.mean, 3) + " mm on average";
  };
  const bool of_poses = !check.names.empty() && check.names.front().id == "robot_ball.held_out";
  return (of_poses
              ? "distance at stations that took no part: "
              : "error of " + Count(static_cast<double>(check.after.size())) + " known lengths that took no part: ") +
         figures(check.after) + "; before: " + figures(check.before) + "\n";
}

bool HasDeclared(const Calibration& c) {
  return std::any_of(c.budget.begin(), c.budget.end(),
                     [](const BudgetLine& line) { return line.type == 'B' && !line.random; });
}

// Where one looks first, and last.
std::string StatusText(const Calibration& c) {
  std::string text;
  for (const std::string& reason : c.unreliable) text += "unreliable: " + reason + "\n";
  return text + "status: " + (c.ok() ? "ok" : "unreliable") + "\n";
}

}  // namespace

std::string ToText(const Calibration& c, bool wide) {
  wide = wide || c.estimated.size() <= kFewParameters;
  const std::string status = StatusText(c);
  std::string text = status + "\n" + ParametersText(c, wide);
  if (!c.estimated.empty()) text += "\n" + BudgetText(c, wide);
  if (!HasDeclared(c)) text += "repeatability and fit only: not a traceable uncertainty\n";
  if (c.monte_carlo.trials > 0) text += "\n" + MonteCarloText(c);
  text += "\n" + Targets(c) + "\n" + LeaveOneOutText(c, wide);
  text += GridText(c.grid) + CheckText(c.check);
  text += "refinement: " + c.residual + " residual, " + std::to_string(c.iterations) + " iterations, " +
          Significant(c.seconds * 1000, 3) + " ms; sigma = " + Significant(c.sigma, 4) + " mm" +
          (c.lack_of_fit.pure_error_sigma > 0
               ? ", within profiles " + Significant(c.lack_of_fit.pure_error_sigma, 4) + " mm"
               : "") +
          "\n";
  if (c.lack_of_fit.dof1 > 0)
    text += "lack of fit: F = " + Significant(c.lack_of_fit.F, 4) + " (" + Count(c.lack_of_fit.dof1) + ", " +
            Count(c.lack_of_fit.dof2) + " degrees of freedom, p " +
            (c.lack_of_fit.p < 1e-16 ? "< 1e-16" : "= " + Significant(c.lack_of_fit.p, 2)) + ")\n";
  if (c.condition > 0) {
    text += "condition: " + Significant(c.condition, 3) + "; least determined direction (by white noise):";
    for (const auto& [name, component] : c.weakest)
      if (c.weakest.size() < kFewNames || std::abs(component) > kTakesPart)
        text += " " + name + " " + Significant(component, 2);
    text += "\n";
  }
  if (c.joint.k > 0)
    text += "k of " + std::to_string(c.estimated.size()) + " quantities jointly (" + CoverageText() +
            " region): " + Significant(c.joint.k, 3) + "; of one: see the table\n";
  text += VolumeText(c.volume);
  if (!wide) text += "u by every estimator, shares and moves of every quantity: --wide\n";
  text += "\n";
  for (const std::string& note : c.notes) text += "note: " + note + "\n";
  for (const std::string& warning : c.warnings) text += "warning: " + warning + "\n";
  return text + status;
}

}  // namespace scancal
