// What `scancal simulate` can make: one entry a model.
#pragma once
#include <vector>
#include "apps/command.h"

namespace scancal {

struct Simulator {
  const char* model;               // as in dataset.yaml
  std::vector<CommandFlag> flags;  // its own, in the order of the help; out, seed and declare belong to all
  int (*run)();                    // writes to --out; exit code
};

Simulator TurntableSimulator();
Simulator RobotSimulator();

}  // namespace scancal
