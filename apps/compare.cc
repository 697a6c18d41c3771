// scancal compare DATASET
#include <gflags/gflags.h>
#include <algorithm>
#include <cstdio>
#include "apps/calibrate.h"
#include "apps/command.h"
#include "io/number.h"
#include "report/text.h"

DECLARE_bool(wide);
DEFINE_string(steps, "1,0.1", "of the published grid search, mm; 0.01 takes seconds");
DEFINE_string(surface, "",
              "CSV file to write: the search's objective S over M and N at the declared step (Fig. 6 of the paper)");

namespace scancal {
namespace {

Result<std::vector<double>> Steps() {
  std::vector<double> steps;
  const std::string& text = FLAGS_steps;
  for (size_t at = 0; at <= text.size();) {
    const size_t end = std::min(text.find(',', at), text.size());
    const ParsedNumber step = ParseNumber(std::string_view(text).substr(at, end - at));
    if (step.kind != NumberKind::kNumber || !(step.value > 0))
      return Error{"--steps: found \"" + text + "\", expected millimetres above zero with commas between, as 1,0.1"};
    steps.push_back(step.value);
    at = end + 1;
  }
  return steps;
}

Result<Comparison> Compared(const std::vector<std::string>& arguments) {
  SCANCAL_ASSIGN_OR_RETURN(const std::vector<double> steps, Steps());
  SCANCAL_ASSIGN_OR_RETURN(const std::unique_ptr<Scanner> scanner, LoadAndEcho(arguments));
  if (!FLAGS_surface.empty()) {
    const Result<void> written = scanner->WriteSurface(FLAGS_surface);
    if (!written.ok()) return Error{"--surface: " + written.error().message};
  }
  return scanner->Compare({.steps = steps});
}

int RunCompare(const std::vector<std::string>& arguments) {
  const Result<Comparison> comparison = Compared(arguments);
  if (!comparison.ok()) return Complain(comparison.error().message);
  Print("\n" + ToText(*comparison, FLAGS_wide));
  return kTrusted;
}

}  // namespace

const Command kCompareCommand = {"compare",
                                 "DATASET",
                                 "the published grid search and the joint refinements on the same data, one table",
                                 {{"steps"}, {"surface"}, {"wide"}},
                                 &RunCompare};

}  // namespace scancal
