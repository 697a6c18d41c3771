// Two calibrations, or many, of one instrument side by side: doubts, text, JSON.
#pragma once
#include <optional>
#include <string>
#include <vector>
#include "io/json_file.h"
#include "solver/results.h"
#include "solver/sentence.h"
#include "solver/uncertainty/control_chart.h"
#include "solver/uncertainty/difference.h"

namespace scancal {

// What makes a comparison of two calibration.json doubtful, worst first: the same file, other models, residuals or
// items, an item that only one of them names, unreliable ones, parameters in other roles, held elsewhere or considered
// in one only, common measurements (by content), common influences that are no number of the system and so count twice.
// The command line and the time of a run take no part.
std::vector<Sentence> DoubtsAbout(const Json& before, const Json& after);

// Where points of a volume lie by the later calibration against the earlier one.
struct Shift {
  size_t points = 0;
  double rms = 0, largest = 0, U_there = 0;  // mm; U of both calibrations there, as if they were independent
  std::string where;                         // the reading of the largest
};

// Of the same readings in both calibrations, in the same order; before.points: at least one.
Shift ShiftOf(const Propagation& before, const Propagation& after);

// "changed", and by what; or that they agree, and within what.
std::string Verdict(const CalibrationDifference& difference);
std::string ToText(const CalibrationDifference& difference, const Calibration& before, const Calibration& after,
                   const std::optional<Shift>& shift);
// {"changes": [{"name", "unit", "change", "u", "U", "E_n"}], "shared", "doubts", "chi_squared", "n", "dof", "p",
// "significant", "verdict"}: what the page shows, too.
Json ToJson(const CalibrationDifference& difference, const std::vector<Sentence>& doubts);

// Charts with what stands below them.
struct History {
  std::vector<std::string> calibrations;  // in order
  std::vector<double> times;
  std::string unit_of_time;         // "calibration", "day"
  std::vector<std::string> shared;  // counted once
  std::vector<ControlChart> charts;
};
std::vector<std::string> AlarmsOf(const History& history);  // a sentence each
std::string ToText(const History& history);
std::string ToCsv(const History& history);  // a line per parameter and calibration; mm and rad
Json ToJson(const History& history);

}  // namespace scancal
