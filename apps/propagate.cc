// scancal propagate CALIBRATION
#include <gflags/gflags.h>
#include <cstdio>
#include "apps/command.h"
#include "apps/recheck.h"
#include "io/output_file.h"
#include "models/models.h"
#include "report/text.h"

DECLARE_string(out);
DEFINE_string(point, "", "readings of one or more points, \"10,50,-20; 12,50,-20\"; may be given again");
DEFINE_string(points_file, "", "table of such readings: CSV with named columns, or .npy");
DEFINE_string(units, "mm,deg", "of these readings: mm, m or um, and deg or rad");
DEFINE_bool(distance, false, "also the distance of each point from the one before");

namespace scancal {
namespace {

// gflags keeps the last value of a flag only, but shows its validator every one.
std::string& TypedPoints() {
  static std::string typed;
  return typed;
}
bool KeepEveryPoint(const char*, const std::string& value) {
  TypedPoints() += value + ";";
  return true;
}

Result<int> Propagated(const std::string& file) {
  SCANCAL_ASSIGN_OR_RETURN(const Units units, ParseUnits(FLAGS_units));
  SCANCAL_ASSIGN_OR_RETURN(const Rechecked checked, RecheckForUse(file));
  const Calibration& calibration = checked.again ? *checked.again : checked.found;  // the same, and more of it
  SCANCAL_ASSIGN_OR_RETURN(const ScannerKind* kind, FindScannerKind(calibration.model, file + ": model"));
  PointRequest points{TypedPoints(), FLAGS_points_file, units};
  if (checked.scanner) {
    YamlMap declared = checked.scanner->dataset().yaml;
    points.angle_sense = declared.Text("rotation", "") == "counterclockwise" ? -1 : 1;
    points.declared = declared;
    points.depth_sense = declared.Text("depth", "") == "towards" ? -1 : 1;
  }
  SCANCAL_ASSIGN_OR_RETURN(const Propagation propagation, kind->Propagate(calibration, points, FLAGS_distance));
  if (!FLAGS_out.empty()) SCANCAL_RETURN_IF_ERROR(WriteFile(FLAGS_out, ToCsv(propagation)));
  std::printf("%s", ToText(propagation).c_str());
  for (const std::string& warning : propagation.warnings)
    std::fprintf(stderr, "scancal: warning: %s\n", warning.c_str());
  return WarnOf(checked, file);
}

int RunPropagate(const std::vector<std::string>& arguments) {
  if (arguments.size() != 1)
    return Complain("found " + std::to_string(arguments.size()) + " arguments, expected one: a calibration.json");
  const Result<int> code = Propagated(arguments[0]);
  return code.ok() ? *code : Complain(code.error().message);
}

}  // namespace

const Command kPropagateCommand = {
    "propagate",
    "CALIBRATION",
    "uncertainty of points and distances that the calibrated scanner measures",
    {{"point"}, {"points_file"}, {"units"}, {"distance"}, {"out", "CSV file to write"}, {"unreliable"}, {"key"}},
    &RunPropagate};

}  // namespace scancal

DEFINE_validator(point, &scancal::KeepEveryPoint);
