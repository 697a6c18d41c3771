// scancal montecarlo DATASET
#include <gflags/gflags.h>
#include "apps/calibrate.h"
#include "apps/command.h"

DECLARE_uint64(seed);
DEFINE_int32(trials, 10'000, "trials; at two digits as many as it takes, at most these (then 1000000 unless given)");
DEFINE_int32(digits, 1, "significant digits of u to which value +- U is validated: 1 or 2 (adaptive)");
DEFINE_int32(threads, 0, "0: one for every core; the digits of the result do not depend on it");

namespace scancal {
namespace {

constexpr int kMostAtTwoDigits = 1'000'000;

int RunMonteCarlo(const std::vector<std::string>& arguments) {
  if (FLAGS_digits != 1 && FLAGS_digits != 2)
    return Complain("--digits: found " + std::to_string(FLAGS_digits) + ", expected 1 or 2");
  if (FLAGS_threads < 0 || FLAGS_threads > 1000)
    return Complain("--threads: found " + std::to_string(FLAGS_threads) + ", expected 0 (one for every core) to 1000");
  const Result<void> sensible = CheckTrials("trials", FLAGS_trials);
  if (!sensible.ok()) return Complain(sensible.error().message);
  const bool given = !gflags::GetCommandLineFlagInfoOrDie("trials").is_default;
  const int trials = FLAGS_digits == 1 || given ? FLAGS_trials : kMostAtTwoDigits;
  RefineChoice choice;
  choice.monte_carlo = {trials, FLAGS_seed, FLAGS_digits, FLAGS_threads};
  return CalibrateAndReport(arguments, choice);
}

}  // namespace

const Command kMonteCarloCommand = {"montecarlo",
                                    "DATASET",
                                    "calibrate, and check value +- U by repeating the whole estimation (JCGM 101)",
                                    {{"out", "folder for calibration.json (default: the current one)"},
                                     {"report"},
                                     {"language"},
                                     {"trials"},
                                     {"seed", "of all draws: the same seed gives the same digits"},
                                     {"digits"},
                                     {"threads"},
                                     {"wide"},
                                     {"sign"},
                                     {"accept_unreliable"}},
                                    &RunMonteCarlo};

}  // namespace scancal
