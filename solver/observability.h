// What the data determine, in names of quantities.
#pragma once
#include <string>
#include <vector>
#include "solver/linearize.h"

namespace scancal {

// Of the system's estimated quantities, after each target's own have been eliminated. Columns are scaled by their
// length before elimination, so that a singular value is the part of a quantity's effect that no target can imitate.
struct Observability {
  Eigen::VectorXd singular;                       // descending
  double condition = 0;                           // largest / smallest singular value
  Eigen::VectorXd weakest;                        // unit vector of the least determined direction, scaled quantities
  std::vector<std::string> undetermined;          // system quantities in directions without effect
  std::vector<std::string> undetermined_targets;  // targets whose own quantities are not determined
};

Observability Observe(const Problem& problem, const Linearization& linear);

}  // namespace scancal
