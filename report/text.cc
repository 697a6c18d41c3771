#include "report/text.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include "io/units.h"
#include "report/text_table.h"
#include "report/uncertainty_text.h"

namespace scancal {
namespace {

constexpr size_t kFewNames = 6, kMostTargets = 30;
constexpr double kTakesPart = 0.2;  // of a unit vector

std::string Shown(double number) { return number > 0 ? Significant(number, 2) : "-"; }

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
  return "error of " + Count(static_cast<double>(check.after.size())) +
         " known lengths that took no part: " + figures(check.after) + "; before: " + figures(check.before) + "\n";
}

bool HasDeclared(const Calibration& c) {
  return std::any_of(c.budget.begin(), c.budget.end(),
                     [](const BudgetLine& line) { return line.type == 'B' && !line.random; });
}

std::string CellText(const ComparisonCell& cell, int digits) {
  if (!cell.value) return "-";
  if (cell.u > 0) return Concise(*cell.value, cell.u);
  return digits == 0 ? Count(*cell.value) : Significant(*cell.value, digits);
}

}  // namespace

std::string ToText(const Calibration& c) {
  std::string text = ParametersText(c);
  if (!c.estimated.empty()) text += "\n" + BudgetText(c);
  if (!HasDeclared(c)) text += "repeatability and fit only: not a traceable uncertainty\n";
  if (c.monte_carlo.trials > 0) text += "\n" + MonteCarloText(c);
  text += "\n" + Targets(c) + "\n" + LeaveOneOutText(c);
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
    text += "k of " + std::to_string(c.estimated.size()) +
            " quantities jointly (95 % region): " + Significant(c.joint.k, 3) + "; of one: see the table\n";
  text += VolumeText(c.volume);
  text += "\n";
  for (const std::string& warning : c.warnings) text += "warning: " + warning + "\n";
  for (const std::string& reason : c.unreliable) text += "unreliable: " + reason + "\n";
  text += std::string("status: ") + (c.ok() ? "ok" : "unreliable") + "\n";
  return text;
}

std::string ToText(const Comparison& comparison) {
  std::vector<std::string> header = {"method"};
  for (const ComparisonColumn& column : comparison.columns) header.push_back(column.name);
  TextTable table(header);
  std::string notes;
  for (const ComparisonRow& row : comparison.rows) {
    if (!row.note.empty()) notes += row.method + ": " + row.note + "\n";
    std::vector<std::string> cells = {row.method};
    for (size_t k = 0; k < row.cells.size(); ++k) cells.push_back(CellText(row.cells[k], comparison.columns[k].digits));
    cells.resize(header.size(), "-");
    table.Add(cells);
  }
  return table.Text() + notes;
}

}  // namespace scancal
