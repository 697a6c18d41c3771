// scancal simulate
#include "apps/simulate.h"
#include <gflags/gflags.h>

DECLARE_string(out);
DEFINE_string(model, "turntable", "what to simulate: turntable or robot-ball");
DEFINE_bool(declare, false, "write what was simulated to dataset.yaml as influences");
DEFINE_uint64(seed, 1, "of all random numbers: the same seed gives the same files");

namespace scancal {
namespace {

std::vector<Simulator> Simulators() { return {TurntableSimulator(), RobotSimulator()}; }

std::vector<CommandFlag> Flags() {
  std::vector<CommandFlag> flags = {{"model"}, {"out", "folder of the data set to write"}, {"seed"}, {"declare"}};
  for (const Simulator& simulator : Simulators())
    flags.insert(flags.end(), simulator.flags.begin(), simulator.flags.end());
  return flags;
}

int Run(const std::vector<std::string>& arguments) {
  if (!arguments.empty()) return Complain("simulate takes no argument; the folder is given by --out");
  if (FLAGS_out.empty()) return Complain("--out: expected the folder to write");
  int (*run)() = nullptr;
  for (const Simulator& simulator : Simulators()) {
    if (FLAGS_model == simulator.model) {
      run = simulator.run;
      continue;
    }
    for (const CommandFlag& flag : simulator.flags)
      if (!gflags::GetCommandLineFlagInfoOrDie(flag.name).is_default)
        return Complain(std::string("--") + flag.name + " belongs to --model=" + simulator.model +
                        ", found --model=" + FLAGS_model);
  }
  return run ? run() : Complain("--model: found \"" + FLAGS_model + "\", expected turntable or robot-ball");
}

}  // namespace

const Command kSimulateCommand = {"simulate", "", "write a data set with known truth", Flags(), &Run};

}  // namespace scancal
