// NIST's certified nonlinear regressions (Statistical Reference Datasets), read from their files.
#pragma once
#include <filesystem>
#include <string>
#include <vector>
#include "io/result.h"
#include "models/selftest/nist_models.h"
#include "solver/results.h"

namespace scancal {

struct NistData {
  std::string level;                            // "Higher"
  std::vector<double> start;                    // "Start 2", the nearer one
  std::vector<std::string> values, deviations;  // certified, as printed
  std::vector<Observation> observations;
  std::string note;  // a misprint that was corrected
};

// The header of a file says between which lines the parameters and the data stand. Wrong cells are named by line.
Result<NistData> ReadNist(const std::filesystem::path& file, const NistModel& model);

// From start 2, against the certified values: at least 8 digits of the parameters and 6 of their standard deviations.
SelftestRow Check(const NistModel& model, const NistData& data);

}  // namespace scancal
