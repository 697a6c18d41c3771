// scancal diff A B
#include <fmt/format.h>
#include <gflags/gflags.h>
#include <cstdio>
#include "apps/command.h"
#include "apps/recheck.h"
#include "models/models.h"
#include "report/difference.h"

DECLARE_string(format);

namespace scancal {
namespace {

// Points of the first one's volume, by either; none where a model has no volume.
Result<std::optional<Shift>> ShiftOver(const Calibration& a, const Calibration& b, const std::string& file) {
  const auto X = std::find(a.volume.columns.begin(), a.volume.columns.end(), "X");
  if (a.volume.rows.empty() || X == a.volume.columns.end()) return std::optional<Shift>();
  SCANCAL_ASSIGN_OR_RETURN(const ScannerKind* kind, FindScannerKind(a.model, file + ": model"));
  PointRequest points;
  SCANCAL_ASSIGN_OR_RETURN(points.units, ParseUnits("mm,rad"));
  for (const std::vector<double>& row : a.volume.rows)
    points.typed += fmt::format("{};", fmt::join(row.begin(), row.begin() + (X - a.volume.columns.begin()), ","));
  SCANCAL_ASSIGN_OR_RETURN(const Propagation before, kind->Propagate(a, points, false));
  SCANCAL_ASSIGN_OR_RETURN(const Propagation after, kind->Propagate(b, points, false));
  return std::optional(ShiftOf(before, after));
}

Result<int> Compared(const std::string& a, const std::string& b) {
  if (!FLAGS_format.empty() && FLAGS_format != "text" && FLAGS_format != "json")
    return Error{"--format: found \"" + FLAGS_format + "\", expected text or json"};
  SCANCAL_ASSIGN_OR_RETURN(const Rechecked before, RecheckForUse(CalibrationIn(a)));
  SCANCAL_ASSIGN_OR_RETURN(const Rechecked after, RecheckForUse(CalibrationIn(b)));
  if (before.found.model != after.found.model)
    return Error{b + ": is of model \"" + after.found.model + "\", but " + a + " of \"" + before.found.model +
                 "\"; expected two calibrations of one instrument"};
  const CalibrationDifference difference =
      DifferenceOf(SeriesOf(std::vector{before.found, after.found}, AnewInEachCalibration()));
  const std::vector<Sentence> doubts = DoubtsAbout(before.file, after.file);
  if (FLAGS_format == "json") {
    std::printf("%s\n", ToJson(difference, doubts).dump(1).c_str());
  } else {
    SCANCAL_ASSIGN_OR_RETURN(const std::optional<Shift> shift, ShiftOver(before.found, after.found, a));
    fmt::print("A: {}\nB: {}\n\n{}", a, b, ToText(difference, before.found, after.found, shift));
    for (const Sentence& doubt : doubts) fmt::print("doubtful: {}\n", doubt.english);
    fmt::print("{}\n", Verdict(difference));
  }
  const int codes = WarnOf(before, a) | WarnOf(after, b);
  return difference.significant() ? kFoundOut : codes;
}

int RunDiff(const std::vector<std::string>& arguments) {
  if (arguments.size() != 2)
    return Complain("found " + std::to_string(arguments.size()) +
                    " arguments, expected two: calibration.json of then and of now");
  const Result<int> code = Compared(arguments[0], arguments[1]);
  return code.ok() ? *code : Complain(code.error().message);
}

}  // namespace

const Command kDiffCommand = {"diff",
                              "A B",
                              "what changed between two calibrations, with its uncertainty and E_n",
                              {{"format", "text or json"}, {"unreliable"}, {"key"}},
                              &RunDiff};

}  // namespace scancal
