// scancal refine DATASET
#include <gflags/gflags.h>
#include "apps/batch.h"
#include "apps/calibrate.h"
#include "apps/command.h"

DEFINE_string(residual, "depth",
              "depth (measured depth minus the depth that the model predicts) or plane (plain "
              "point-to-plane, biased)");
DEFINE_string(weights, "estimated",
              "estimated (generalised least squares with the variances that the residuals show) or equal");
DEFINE_int32(max_iterations, 100, "most iterations of the refinement");
DEFINE_string(
    batch, "",
    "text file with a data set a line (-: standard input), in place of DATASET: all of them on all cores, each "
    "in a folder of its own below --out, with summary.csv and summary.json there; again, only what changed");
DECLARE_string(out);
DECLARE_int32(threads);
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
  if (FLAGS_threads < 0 || FLAGS_threads > 1000)
    return Complain("--threads: found " + std::to_string(FLAGS_threads) + ", expected 0 (one for every core) to 1000");
  if (!FLAGS_batch.empty()) {
    const Result<void> spoken = CheckLanguage();
    if (!spoken.ok()) return Complain(spoken.error().message);
    if (!arguments.empty())
      return Complain("--batch: found \"" + arguments[0] + "\" besides, expected all data sets in " + FLAGS_batch);
    if (FLAGS_out.empty()) return Complain("--batch: found no --out, expected --out=DIR for the results");
    return RefineBatch(FLAGS_batch, FLAGS_out, FLAGS_threads);
  }
  if (FLAGS_threads != 0 && FLAGS_montecarlo == 0)
    return Complain("--threads: expected beside --batch or --montecarlo; a single refinement knows no such choice");
  return CalibrateAndReport(arguments, {FLAGS_residual,
                                        FLAGS_weights == "equal",
                                        FLAGS_max_iterations,
                                        {.trials = FLAGS_montecarlo, .threads = FLAGS_threads}});
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
     {"wide"},
     {"sign"},
     {"batch"},
     {"threads", "with --batch: data sets at a time; of a Monte Carlo. 0: one for every core"},
     {"resume"},
     {"accept_unreliable"}},
    &RunRefine};

}  // namespace scancal
