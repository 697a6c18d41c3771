// The scenes in which a stated interval must hold the truth, and how wide it may be.
#pragma once
#include <functional>
#include <limits>
#include <string>
#include <vector>
#include "models/turntable/simulate.h"

namespace scancal::coverage {

struct Row {
  std::string name;
  turntable::Scene scene;                                   // the truth; every data set has a seed of its own
  double declared_form = 0;                                 // mm rms
  std::function<void(Random*, turntable::Scene*)> draw{};   // what is another in every data set, besides its noise
  std::function<void(turntable::Model*)> declare{};         // further influences
  bool begins_anew = false;                                 // the data set says that no drift goes on between scans
  double least = 0.93, most = 0.97;                         // wanted share of data sets that hold M, and N
  double widest = std::numeric_limits<double>::infinity();  // wanted median width against the oracle
};

// Three placements of 100 profiles of 100 points; sweep in degrees. The table of
// docs/proof.md; the robot's is made by tests/robot_study.
std::vector<Row> Rows(double sweep_deg = 44);

}  // namespace scancal::coverage
