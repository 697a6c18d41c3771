// scancal refine DATASET
#include <gflags/gflags.h>
#include "apps/calibrate.h"
#include "apps/command.h"

DEFINE_string(residual, "depth",
              "depth (measured depth minus the depth that the model predicts) or plane (plain "
              "point-to-plane, biased)");
DEFINE_string(weights, "estimated",
              "estimated (generalised least squares with the variances that the residuals show) or equal");
DEFINE_int32(max_iterations, 100, "most iterations of the refinement");
DEFINE_int32(montecarlo, 0, "trials of a Monte Carlo with seed 1, see scancal montecarlo; 0: none");

namespace scancal {
namespace {

int RunRefine(const std::vector<std::string>& arguments) {
  if (FLAGS_max_iterations < 1) return Complain("--max_iterations: expected 1 or more");
  if (FLAGS_weights != "estimated" && FLAGS_weights != "equal")
    return Complain("--weights: found \"" + FLAGS_weights + "\", expected estimated or equal");
  if (FLAGS_montecarlo != 0) {
    const Result<void> trials = CheckTrials("montecarlo", FLAGS_montecarlo);
    if (!trials.ok()) return Complain(trials.error().message);
  }
  return CalibrateAndReport(
      arguments, {FLAGS_residual, FLAGS_weights == "equal", FLAGS_max_iterations, {.trials = FLAGS_montecarlo}});
}

}  // namespace

const Command kRefineCommand = {
    "refine",
    "DATASET",
    "calibrate: search, joint refinement, uncertainty; writes calibration.json, which can stand for DATASET later",
    {{"out", "folder for calibration.json (default: the current one)"},
     {"report"},
     {"language"},
     {"residual"},
     {"weights"},
     {"max_iterations"},
     {"montecarlo"},
     {"sign"}},
    &RunRefine};

}  // namespace scancal
