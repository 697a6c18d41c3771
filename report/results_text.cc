#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include "io/units.h"
#include "report/text.h"

namespace scancal {
namespace {

std::string CellText(const ComparisonCell& cell, int digits) {
  if (!cell.value) return "-";
  if (cell.u > 0) return Concise(*cell.value, cell.u);
  return digits == 0 ? Count(*cell.value) : Significant(*cell.value, digits);
}

std::string OneDecimal(double digits) { return fmt::format("{:.1f}", std::floor(10 * digits) / 10); }  // never up

std::string CountOrNone(int count) { return count > 0 ? std::to_string(count) : "-"; }

constexpr const char* kAxes[] = {"X", "Y", "Z"};

double Shown(double value, Unit unit) { return unit == Unit::kRad ? value / kDegree : value; }
const char* ShownUnit(Unit unit) { return unit == Unit::kRad ? "deg" : Name(unit); }

std::string PointTable(const Propagation& propagation) {
  std::vector<std::string> header = {"point"};
  for (size_t k = 0; k < propagation.reading.size(); ++k)
    header.push_back(propagation.reading[k] + "/" + ShownUnit(propagation.units[k]));
  for (const char* form : {"{}/mm", "U({})/mm"})
    for (const char* axis : kAxes) header.push_back(fmt::format(fmt::runtime(form), axis));
  header.insert(header.end(), {"largest U/mm", "k", "dof"});
  TextTable table(header);
  for (size_t i = 0; i < propagation.points.size(); ++i) {
    const PropagatedPoint& point = propagation.points[i];
    const MeasurandUncertainty& uncertainty = point.uncertainty;
    std::vector<std::string> row = {std::to_string(i + 1)};
    for (size_t k = 0; k < point.reading.size(); ++k)
      row.push_back(Significant(Shown(point.reading[k], propagation.units[k]), 6));
    for (int k = 0; k < 3; ++k)
      row.push_back(Concise(point.position[k], std::sqrt(std::max(0.0, uncertainty.covariance(k, k)))));
    for (int k = 0; k < 3; ++k) row.push_back(Significant(uncertainty.U[k], 2));
    row.insert(row.end(),
               {Significant(uncertainty.U_max, 2), Significant(uncertainty.k, 3), Count(std::floor(uncertainty.dof))});
    table.Add(row);
  }
  return table.Text();
}

std::string DistanceTable(const Propagation& propagation) {
  TextTable table({"distance", "value/mm", "u/mm", "U/mm", "k", "dof"});
  for (const PropagatedDistance& distance : propagation.distances) {
    const MeasurandUncertainty& uncertainty = distance.uncertainty;
    const double u = std::sqrt(std::max(0.0, uncertainty.covariance(0, 0)));
    table.Add({fmt::format("{} to {}", distance.from + 1, distance.to + 1), Concise(distance.value, u),
               Significant(u, 2), Significant(uncertainty.U_max, 2), Significant(uncertainty.k, 3),
               Count(std::floor(uncertainty.dof))});
  }
  return table.Text();
}

}  // namespace

std::string ToText(const Comparison& comparison, bool wide) {
  std::vector<std::string> header = {"method"};
  std::vector<size_t> shown;
  for (size_t k = 0; k < comparison.columns.size(); ++k) {
    if (comparison.columns[k].detail && !wide) continue;
    shown.push_back(k);
    header.push_back(comparison.columns[k].name);
  }
  TextTable table(header);
  std::string notes;
  for (const ComparisonRow& row : comparison.rows) {
    if (!row.note.empty()) notes += row.method.english + ": " + row.note.english + "\n";
    std::vector<std::string> cells = {row.method};
    for (const size_t k : shown)
      if (k < row.cells.size()) cells.push_back(CellText(row.cells[k], comparison.columns[k].digits));
    cells.resize(header.size(), "-");
    table.Add(cells);
  }
  const size_t more = comparison.columns.size() - shown.size();
  if (more > 0) notes += fmt::format("{} more columns: --wide\n", more);
  return table.Text() + notes;
}

std::string ToText(const Propagation& propagation) {
  std::string text = PointTable(propagation);
  if (!propagation.distances.empty()) text += "\n" + DistanceTable(propagation);
  text +=
      "\nin brackets: u, in units of the last digit; U = k u: " + CoverageText() + ", largest over all directions\n";
  for (const std::string& note : propagation.notes) text += note + "\n";
  return text;
}

std::string ToCsv(const Propagation& propagation) {
  std::string text;
  for (size_t k = 0; k < propagation.reading.size(); ++k)
    text += propagation.reading[k] + "_" + ShownUnit(propagation.units[k]) + ",";
  text += "X_mm,Y_mm,Z_mm,u_X_mm,u_Y_mm,u_Z_mm,cov_XY_mm2,cov_XZ_mm2,cov_YZ_mm2,U_X_mm,U_Y_mm,U_Z_mm,U_max_mm,k,dof";
  if (!propagation.distances.empty()) text += ",distance_mm,u_distance_mm,U_distance_mm,k_distance,dof_distance";
  text += "\n";
  for (size_t i = 0; i < propagation.points.size(); ++i) {
    const PropagatedPoint& point = propagation.points[i];
    const MeasurandUncertainty& of_point = point.uncertainty;
    for (size_t k = 0; k < point.reading.size(); ++k)
      text += fmt::format("{},", Shown(point.reading[k], propagation.units[k]));
    const auto& c = of_point.covariance;
    text += fmt::format("{},{},{},", point.position[0], point.position[1], point.position[2]);
    for (int k = 0; k < 3; ++k) text += fmt::format("{},", std::sqrt(std::max(0.0, c(k, k))));
    text += fmt::format("{},{},{},{},{},{},{},{},{}", c(0, 1), c(0, 2), c(1, 2), of_point.U[0], of_point.U[1],
                        of_point.U[2], of_point.U_max, of_point.k, of_point.dof);
    if (!propagation.distances.empty()) {
      if (i == 0) {
        text += ",,,,,";
      } else {
        const PropagatedDistance& distance = propagation.distances[i - 1];
        text += fmt::format(",{},{},{},{},{}", distance.value, std::sqrt(distance.uncertainty.covariance(0, 0)),
                            distance.uncertainty.U_max, distance.uncertainty.k, distance.uncertainty.dof);
      }
    }
    text += "\n";
  }
  return text;
}

std::string ToText(const Selftest& selftest) {
  TextTable table({"case", "difficulty", "observations", "parameters", "digits", "required", "digits of u", "required",
                   "iterations", ""});
  std::string notes;
  size_t passed = 0;
  for (const SelftestRow& row : selftest.rows) {
    table.Add({row.name, row.level.empty() ? "-" : row.level, CountOrNone(row.observations),
               CountOrNone(row.parameters), OneDecimal(row.values.reached), OneDecimal(row.values.required),
               OneDecimal(row.deviations.reached), OneDecimal(row.deviations.required), CountOrNone(row.iterations),
               row.pass() ? "pass" : "FAIL"});
    if (!row.note.empty()) notes += row.name + ": " + row.note + "\n";
    passed += row.pass();
  }
  return table.Text() +
         "digits: -log10 of the relative error of the estimate, and of the standard uncertainty u, nearest to failing\n"
         "GUM: published results, to one unit of their last digit\n" +
         notes +
         fmt::format("\n{} of {} cases passed\nselftest: {}\n", passed, selftest.rows.size(),
                     selftest.ok() ? "pass" : "FAIL");
}

namespace {

// Of a CSV file, in quotes where it has to be.
std::string Cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::string ToText(const Verification& verification) {
  TextTable table({"feature", "at", "kind", "nominal/mm", "measured/mm", "deviation/mm", "u calibration", "u noise",
                   "u reference", "U/mm", "E_n", "form/mm", "points", "set aside"});
  TextTable decisions({"feature", "at", "tolerance/mm", "guard band/mm", "decision", "p of a false accept"});
  bool decided = false;
  for (const VerifiedFeature& f : verification.features) {
    table.Add({f.name, f.at, f.kind, Significant(f.nominal, 7), Concise(f.measured, f.u), Concise(f.deviation(), f.u),
               Significant(f.u_calibration, 2), Significant(f.u_noise, 2), Significant(f.u_reference, 2),
               Significant(f.U, 2), fmt::format("{:.2f}", f.E_n), Significant(f.form, 2), std::to_string(f.points),
               std::to_string(f.set_aside)});
    if (!f.conformity) continue;
    decided = true;
    const Conformity& c = *f.conformity;
    decisions.Add({f.name, f.at, fmt::format("{:g} to {:g}", c.lower, c.upper), Significant(c.guard, 2),
                   Name(c.decision),
                   c.decision != Decision::kAccept ? "-"
                   : c.p_outside < 1e-6            ? "< 1e-6"
                                                   : fmt::format("{:.1g}", c.p_outside)});
  }
  std::string text = table.Text();
  if (decided) text += "\n" + decisions.Text();
  text += "\n";
  for (const std::string& note : verification.notes) text += note + "\n";
  if (verification.scale)
    text += fmt::format(
        "planes cannot see scale_y; these features do: scale_y = {}, U = {} ({}){}\n",
        Concise(verification.scale->value, verification.scale->u), Significant(verification.scale->U, 2),
        CoverageText(),
        std::abs(verification.scale->value) > verification.scale->U
            ? "; depth shows a scale error: declare it, `scale_y: {consider: ..., u: ...}`, and refine again"
            : "");
  const auto out = std::count_if(verification.features.begin(), verification.features.end(),
                                 [](const VerifiedFeature& f) { return f.out(); });
  text += out == 0 ? fmt::format("all {} features agree with their reference\n", verification.features.size())
                   : fmt::format("{} of {} features are out: |E_n| above 1, or rejected\n", out,
                                 verification.features.size());
  return text;
}

std::string ToCsv(const Verification& verification) {
  std::string text =
      "feature,at,kind,nominal_mm,measured_mm,deviation_mm,u_calibration_mm,u_noise_mm,u_reference_mm,u_mm,dof,U_mm,"
      "E_n,form_mm,points,set_aside,lower_mm,upper_mm,guard_mm,decision,p_outside\n";
  for (const VerifiedFeature& f : verification.features) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},", Cell(f.name), Cell(f.at), f.kind, f.nominal,
                        f.measured, f.deviation(), f.u_calibration, f.u_noise, f.u_reference, f.u, f.dof, f.U, f.E_n,
                        f.form, f.points, f.set_aside);
    if (f.conformity)
      text += fmt::format("{},{},{},{},{}\n", f.conformity->lower, f.conformity->upper, f.conformity->guard,
                          Name(f.conformity->decision), f.conformity->p_outside);
    else text += ",,,,\n";
  }
  return text;
}

}  // namespace scancal
