#include "report/difference.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <set>
#include "io/units.h"
#include "report/text.h"
#include "solver/uncertainty/gum.h"

namespace scancal {
namespace {

constexpr Message<> kSameFile{"report.same_file", "Both are the same file.", "Beide sind dieselbe Datei."};
constexpr Message<std::string, std::string> kOtherModels{
    "report.other_models", "The models differ: {}, {}. Parameters of the same name need not mean the same.",
    "Die Modelle sind verschieden: {}, {}. Gleichnamige Parameter müssen nicht dasselbe bedeuten."};
constexpr Message<std::string, std::string> kOtherResiduals{
    "report.other_residuals", "The residuals differ: {}, {}. One of the two may be biased.",
    "Die Residuen sind verschieden: {}, {}. Eines der beiden Ergebnisse kann systematisch verfälscht sein."};
constexpr Message<std::string, std::string> kOtherItems{
    "report.other_items", "The certificates name different items: {}, {}.",
    "Die Kalibrierscheine nennen verschiedene Gegenstände: {}, {}."};
constexpr Message<std::string> kItemOfOne{
    "report.item_of_one",
    "Only one of the two names a serial number ({}): nobody can say that it is the same instrument.",
    "Nur eine von beiden nennt eine Seriennummer ({}): Dass es dasselbe Gerät ist, kann niemand sagen."};
constexpr Message<> kEarlierUnreliable{"report.earlier_unreliable", "The earlier calibration says not to rely on it.",
                                       "Auf die frühere Kalibrierung ist nach ihrem eigenen Urteil kein Verlass."};
constexpr Message<> kLaterUnreliable{"report.later_unreliable", "This calibration says not to rely on it.",
                                     "Auf diese Kalibrierung ist nach ihrem eigenen Urteil kein Verlass."};
constexpr Message<std::string> kMissing{"report.missing_parameters", "Only one of the two knows {}.",
                                        "Nur eine von beiden kennt {}."};
constexpr Message<std::string> kRoles{"report.other_roles",
                                      "Estimated in one and not in the other: {}. The other parameters answer to that.",
                                      "Nur in einer geschätzt: {}. Die übrigen Parameter gleichen das aus."};
constexpr Message<std::string> kHeldElsewhere{
    "report.held_elsewhere", "Held at another value: {}. The other parameters answer to that.",
    "Bei einem anderen Wert festgehalten: {}. Die übrigen Parameter gleichen das aus."};
constexpr Message<std::string> kConsideredInOne{
    "report.considered_in_one", "In the uncertainty of one only, held as exactly known in the other: {}.",
    "Nur in der Messunsicherheit der einen enthalten, in der anderen als genau bekannt festgehalten: {}."};
constexpr Message<std::string> kNominals{"report.other_nominals", "The errors are from other nominal values: {}.",
                                         "Die Abweichungen beziehen sich auf andere Nennwerte: {}."};
constexpr Message<std::string> kCommonInputs{
    "report.common_inputs",
    "Both use the same measurements ({}): they are not independent, E_n is too small, and agreement proves little.",
    "Beide verwenden dieselben Messungen ({}): Sie sind nicht unabhängig, E_n ist zu klein, und Übereinstimmung besagt "
    "wenig."};
constexpr Message<std::string> kCommonInfluences{"report.common_influences",
                                                 "Both declare {}: as far as it is the same plate, artifact or "
                                                 "instrument, the error is common, and E_n is too small.",
                                                 "Beide geben {} an: Soweit es dieselbe Platte, dasselbe Normal oder "
                                                 "dasselbe Gerät ist, ist die Abweichung gemeinsam "
                                                 "und E_n zu klein."};

std::string StringAt(const Json& json, const char* key) {
  const auto found = json.is_object() ? json.find(key) : json.end();
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

const Json& ListAt(const Json& json, const char* key) {
  static const Json none = Json::array();
  const auto found = json.is_object() ? json.find(key) : json.end();
  return found != json.end() && found->is_array() ? *found : none;
}

// What the certificate calls the thing that was calibrated, if it does.
std::string ItemOf(const Json& file) {
  const Json certificate = file.value("certificate", Json());
  if (!certificate.is_object() || !certificate.contains("item")) return "";
  std::string item;
  for (const Json& each : ListAt(certificate["item"], "identifications")) {
    const Json value = each.is_object() ? each.value("value", Json()) : Json();
    const std::string text = value.is_string() ? value.get<std::string>() : value.is_primitive() ? value.dump() : "";
    if (!value.is_null() && !text.empty()) item += (item.empty() ? "" : ", ") + text;
  }
  return item;
}

std::string Names(const std::vector<std::string>& names) {
  constexpr size_t kMost = 8;
  std::string text;
  for (size_t k = 0; k < std::min(kMost, names.size()); ++k) text += (k ? ", " : "") + names[k];
  return text + (names.size() > kMost ? fmt::format(" + {}", names.size() - kMost) : "");
}

const Json* Named(const Json& list, const std::string& name) {
  for (const Json& each : list)
    if (StringAt(each, "name") == name) return &each;
  return nullptr;
}

// Systematic, declared in both, and no number of the system: a form, a ball of the artifact.
std::vector<std::string> CommonInfluences(const Json& before, const Json& after) {
  std::set<std::string> declared;
  for (const Json& each : ListAt(before, "budget"))
    if (StringAt(each, "type") == "B") declared.insert(StringAt(each, "source"));
  std::set<std::string> random;
  for (const Json& each : ListAt(after, "influences"))
    if (const std::string scope = StringAt(each, "scope"); scope == "view" || scope == "point")
      random.insert(StringAt(each, "source"));
  std::vector<std::string> common;
  for (const Json& each : ListAt(after, "budget")) {
    const std::string source = StringAt(each, "source");
    const bool counted_once = each.contains("sensitivity") && !each["sensitivity"].empty();
    if (StringAt(each, "type") == "B" && declared.contains(source) && !counted_once && !random.contains(source))
      common.push_back(source);
  }
  return common;
}

std::vector<std::string> CommonInputs(const Json& before, const Json& after) {
  std::set<std::string> earlier;
  for (const Json& each : ListAt(before, "inputs")) earlier.insert(StringAt(each, "sha256"));
  std::vector<std::string> common;
  for (const Json& each : ListAt(after, "inputs")) {
    const std::string file = StringAt(each, "file"), sha256 = StringAt(each, "sha256");
    const bool declares = file.ends_with(".yaml") || file.ends_with(".yml");  // is no measurement
    if (!sha256.empty() && !declares && earlier.contains(sha256)) common.push_back(file);
  }
  return common;
}

// Where it is held or considered; without one it is 0.
double HeldAt(const Json& parameter) {
  const auto value = parameter.find("value");
  return value != parameter.end() && value->is_number() ? value->get<double>() : 0;
}

void AddDoubtsAboutParameters(const Json& before, const Json& after, std::vector<Sentence>* doubts) {
  std::vector<std::string> missing, roles, held, considered, nominals;
  for (const Json& each : ListAt(before, "parameters"))
    if (!Named(ListAt(after, "parameters"), StringAt(each, "name"))) missing.push_back(StringAt(each, "name"));
  for (const Json& each : ListAt(after, "parameters")) {
    const std::string name = StringAt(each, "name"), role = StringAt(each, "role");
    const Json* earlier = Named(ListAt(before, "parameters"), name);
    if (!earlier) {
      missing.push_back(name);
      continue;
    }
    const std::string role_then = StringAt(*earlier, "role");
    if ((role == "estimate") != (role_then == "estimate")) roles.push_back(name);
    else if (role != "estimate" && HeldAt(each) != HeldAt(*earlier)) held.push_back(name);
    else if (role != role_then) considered.push_back(name);
    if (each.value("nominal", Json()) != earlier->value("nominal", Json())) nominals.push_back(name);
  }
  std::sort(missing.begin(), missing.end());
  if (!missing.empty()) doubts->push_back(Say(kMissing, Names(missing)));
  if (!roles.empty()) doubts->push_back(Say(kRoles, Names(roles)));
  if (!held.empty()) doubts->push_back(Say(kHeldElsewhere, Names(held)));
  if (!considered.empty()) doubts->push_back(Say(kConsideredInOne, Names(considered)));
  if (!nominals.empty()) doubts->push_back(Say(kNominals, Names(nominals)));
}

Json NumberOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string UnitText(Unit unit) { return unit == Unit::kOne ? "" : std::string(" ") + Name(unit); }

const ParameterChange& Largest(const CalibrationDifference& difference) {
  return *std::max_element(difference.changes.begin(), difference.changes.end(), [](const auto& a, const auto& b) {
    return !(std::abs(a.E_n) >= std::abs(b.E_n)) && !std::isnan(b.E_n);
  });
}

std::string StateOf(const ChartPoint& point) {
  return std::string(point.beyond ? "beyond the limits" : "") + (point.beyond && point.alarm ? ", " : "") +
         (point.alarm ? "CUSUM alarm" : "");
}

}  // namespace

std::vector<Sentence> DoubtsAbout(const Json& before, const Json& after) {
  std::vector<Sentence> doubts;
  if (before == after) doubts.push_back(Say(kSameFile));
  const auto differ = [&](const auto& message, const std::string& a, const std::string& b) {
    if (!a.empty() && !b.empty() && a != b) doubts.push_back(Say(message, a, b));
  };
  differ(kOtherModels, StringAt(before, "model"), StringAt(after, "model"));
  differ(kOtherResiduals, StringAt(before, "residual"), StringAt(after, "residual"));
  const std::string item_then = ItemOf(before), item_now = ItemOf(after);
  differ(kOtherItems, item_then, item_now);
  if (item_then.empty() != item_now.empty()) doubts.push_back(Say(kItemOfOne, item_then + item_now));
  if (StringAt(before, "status") != "ok") doubts.push_back(Say(kEarlierUnreliable));
  if (StringAt(after, "status") != "ok") doubts.push_back(Say(kLaterUnreliable));
  AddDoubtsAboutParameters(before, after, &doubts);
  if (const auto names = CommonInputs(before, after); !names.empty())
    doubts.push_back(Say(kCommonInputs, Names(names)));
  if (const auto names = CommonInfluences(before, after); !names.empty())
    doubts.push_back(Say(kCommonInfluences, Names(names)));
  return doubts;
}

Shift ShiftOf(const Propagation& before, const Propagation& after) {
  Shift shift{before.points.size(), 0, 0, 0, ""};
  for (size_t i = 0; i < before.points.size(); ++i) {
    const PropagatedPoint &a = before.points[i], &b = after.points[i];
    const double moved = (b.position - a.position).norm();
    shift.rms += moved * moved / static_cast<double>(shift.points);
    if (moved < shift.largest) continue;
    shift.largest = moved;
    shift.U_there = std::hypot(a.uncertainty.U_max, b.uncertainty.U_max);
    shift.where.clear();
    for (size_t k = 0; k < before.reading.size(); ++k) {
      const bool turns = before.units[k] == Unit::kRad;
      shift.where += fmt::format("{}{} = {} {}", k ? ", " : "", before.reading[k],
                                 Significant(turns ? a.reading[k] / kDegree : a.reading[k], 3), turns ? "deg" : "mm");
    }
  }
  shift.rms = std::sqrt(shift.rms);
  return shift;
}

std::string Verdict(const CalibrationDifference& difference) {
  if (difference.n == 0)
    return "the two have no estimated parameter with an uncertainty in common: nothing can be said";
  const std::string chance =
      difference.p < 1e-4 ? "less than 1 in 10,000" : fmt::format("{:.2g} %", 100 * difference.p);
  const ParameterChange& most = Largest(difference);
  if (!difference.significant())
    return fmt::format("the two agree within what is known of them: differences as large come about by chance in {}",
                       chance);
  return fmt::format("the two differ: differences as large come about by chance in {}; most for its U does {}, by {}{}",
                     chance, most.name, Concise(most.change, most.u), UnitText(most.unit));
}

std::string ToText(const CalibrationDifference& difference, const Calibration& before, const Calibration& after,
                   const std::optional<Shift>& shift) {
  TextTable table({"", "A", "B", "unit", "B - A", "u", "U (" + CoverageText() + ")", "E_n"});
  for (const ParameterChange& each : difference.changes) {
    const Parameter &a = *before.Find(each.name), &b = *after.Find(each.name);
    table.Add({each.name, Concise(a.value, a.u), Concise(b.value, b.u), Name(each.unit), Concise(each.change, each.u),
               Significant(each.u, 2), Significant(each.U, 2), fmt::format("{:.2f}", each.E_n)});
  }
  std::string text = difference.changes.empty() ? "" : table.Text();
  if (!difference.shared.empty())
    text += "counted once, as one and the same error in both: " + Names(difference.shared) + "\n";
  if (difference.n > 0)
    text += fmt::format("chi-squared of all: {:.2f}, {} degrees of freedom, p = {:.2g}\n", difference.chi_squared,
                        Count(difference.n), difference.p);
  if (shift)
    text += fmt::format(
        "points over the volume of A: moved by {} mm rms, at most {} mm (at {}; U of both there: {} mm)\n",
        Significant(shift->rms, 2), Significant(shift->largest, 2), shift->where, Significant(shift->U_there, 2));
  return text;
}

Json ToJson(const CalibrationDifference& difference, const std::vector<Sentence>& doubts) {
  Json json = {{"changes", Json::array()},
               {"shared", difference.shared},
               {"doubts", Json::array()},
               {"chi_squared", NumberOrNull(difference.chi_squared)},
               {"n", difference.n},
               {"dof", NumberOrNull(difference.dof)},
               {"p", NumberOrNull(difference.p)},
               {"significant", difference.significant()},
               {"verdict", Verdict(difference)}};
  for (const ParameterChange& each : difference.changes)
    json["changes"].push_back({{"name", each.name},
                               {"unit", Name(each.unit)},
                               {"change", NumberOrNull(each.change)},
                               {"u", NumberOrNull(each.u)},
                               {"U", NumberOrNull(each.U)},
                               {"E_n", NumberOrNull(each.E_n)}});
  for (const Sentence& doubt : doubts) json["doubts"].push_back({{"en", doubt.english}, {"de", doubt.german}});
  return json;
}

std::vector<std::string> AlarmsOf(const History& history) {
  std::vector<std::string> alarms;
  for (const ControlChart& chart : history.charts) {
    for (size_t i = 0; i < chart.points.size(); ++i)
      if (chart.points[i].beyond)
        alarms.push_back(fmt::format("{}: {} lies {:+.1f} u from the centre, beyond the limits", chart.name,
                                     history.calibrations[i], chart.points[i].deviation));
    const auto first =
        std::find_if(chart.points.begin(), chart.points.end(), [](const ChartPoint& p) { return p.alarm; });
    if (first != chart.points.end())
      alarms.push_back(fmt::format("{}: CUSUM alarm at {}: {} since some calibrations", chart.name,
                                   history.calibrations[static_cast<size_t>(first - chart.points.begin())],
                                   first->up > first->down ? "larger" : "smaller"));
    if (chart.drifts)
      alarms.push_back(fmt::format("{}: drifts by {}{} a {}, {:.1f} times its u", chart.name,
                                   Concise(chart.slope, chart.u_slope), UnitText(chart.unit), history.unit_of_time,
                                   std::abs(chart.slope) / chart.u_slope));
  }
  return alarms;
}

std::string ToText(const History& history) {
  const ChartLimits limits = LimitsOf(history.charts.size());
  TextTable summary({"", "unit", "centre", "drift a " + history.unit_of_time, "drift in u", "chi-squared", "p"});
  TextTable points({"", "calibration", history.unit_of_time, "value", "U (" + CoverageText() + ")", "limits", "",
                    "in u", "CUSUM +", "-", ""});
  for (const ControlChart& chart : history.charts) {
    const bool sloped = chart.u_slope > 0;
    summary.Add({chart.name, Name(chart.unit), Concise(chart.centre, chart.u_centre),
                 sloped ? Concise(chart.slope, chart.u_slope) : "-",
                 sloped ? fmt::format("{:+.1f}", chart.slope / chart.u_slope) : "-",
                 fmt::format("{:.1f}", chart.chi_squared), fmt::format("{:.2g}", chart.p)});
    for (size_t i = 0; i < chart.points.size(); ++i) {
      const ChartPoint& p = chart.points[i];
      points.Add({chart.name, history.calibrations[i], Significant(history.times[i], 4), Concise(p.value, p.u),
                  Significant(p.U, 2), Concise(p.low, p.u), Concise(p.high, p.u), fmt::format("{:+.1f}", p.deviation),
                  fmt::format("{:.1f}", p.up), fmt::format("{:.1f}", p.down), StateOf(p)});
    }
  }
  std::string text = summary.Text() + "\n" + points.Text();
  text += fmt::format("limits: centre -+ {:.2f} u; CUSUM: beyond {:g} u a calibration, alarm above {:.1f} u\n",
                      limits.k, kCusumSlack, limits.h);
  if (!history.shared.empty()) text += "one and the same error in several: " + Names(history.shared) + "\n";
  return text;
}

std::string ToCsv(const History& history) {
  std::string text = "parameter,unit,calibration," + history.unit_of_time +
                     ",value,u,U,centre,low,high,deviation_in_u,cusum_up,cusum_down,beyond,alarm\n";
  const auto quoted = [](const std::string& name) {
    std::string cell = "\"";
    for (const char c : name) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
    return name.find_first_of(",\"\n") == std::string::npos ? name : cell + "\"";
  };
  for (const ControlChart& chart : history.charts)
    for (size_t i = 0; i < chart.points.size(); ++i) {
      const ChartPoint& p = chart.points[i];
      text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{:d},{:d}\n", chart.name, Name(chart.unit),
                          quoted(history.calibrations[i]), history.times[i], p.value, p.u, p.U, chart.centre, p.low,
                          p.high, p.deviation, p.up, p.down, p.beyond, p.alarm);
    }
  return text;
}

Json ToJson(const History& history) {
  const ChartLimits limits = LimitsOf(history.charts.size());
  Json json = {{"calibrations", history.calibrations},
               {"times", history.times},
               {"unit_of_time", history.unit_of_time},
               {"shared", history.shared},
               {"limit", limits.k},
               {"cusum", {{"slack", kCusumSlack}, {"alarm", limits.h}}},
               {"charts", Json::array()},
               {"alarms", AlarmsOf(history)}};
  for (const ControlChart& chart : history.charts) {
    Json points = Json::array();
    for (const ChartPoint& p : chart.points)
      points.push_back({{"value", NumberOrNull(p.value)},
                        {"u", NumberOrNull(p.u)},
                        {"U", NumberOrNull(p.U)},
                        {"low", NumberOrNull(p.low)},
                        {"high", NumberOrNull(p.high)},
                        {"deviation", NumberOrNull(p.deviation)},
                        {"up", NumberOrNull(p.up)},
                        {"down", NumberOrNull(p.down)},
                        {"beyond", p.beyond},
                        {"alarm", p.alarm}});
    json["charts"].push_back({{"name", chart.name},
                              {"unit", Name(chart.unit)},
                              {"centre", NumberOrNull(chart.centre)},
                              {"u_centre", NumberOrNull(chart.u_centre)},
                              {"slope", NumberOrNull(chart.slope)},
                              {"u_slope", NumberOrNull(chart.u_slope)},
                              {"drifts", chart.drifts},
                              {"chi_squared", NumberOrNull(chart.chi_squared)},
                              {"p", NumberOrNull(chart.p)},
                              {"points", points}});
  }
  return json;
}

}  // namespace scancal
