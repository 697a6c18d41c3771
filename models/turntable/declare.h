// What a turntable's dataset.yaml declares.
#pragma once
#include <optional>
#include <string>
#include <vector>
#include "io/dataset.h"
#include "io/scan.h"
#include "models/turntable.h"
#include "solver/grid_search.h"
#include "solver/sentence.h"

namespace scancal::turntable {

struct KeepInterval {
  std::string column;
  double lower = 0, upper = 0;  // mm, rad; of an unknown column as in the file
  bool operator==(const KeepInterval&) const = default;
};

struct ScanDeclaration {  // one target: one placement of the plate
  std::string name;
  std::string scan;  // as written
  ScanFormat format;
  std::vector<KeepInterval> keep;
};

struct Declaration {
  Dataset dataset;
  double sense = 1;  // alpha = sense * reading: clockwise seen from +Z is positive
  GridBox search;    // of M and N, mm
  std::vector<ScanDeclaration> scans;
  std::optional<double> line_correlation;  // points; declared
  std::vector<Sentence> warnings;          // worth knowing
};

// Takes every key of the data set; role, value and u of `model`'s quantities are set from parameters and influences. An
// Error names the key and what was expected.
Result<Declaration> Declare(const Dataset& dataset, Model* model);

}  // namespace scancal::turntable
