// scipy.optimize.least_squares on the same points, in a process of its own.
#pragma once
#include <filesystem>
#include <string>
#include "tests/bench/comparisons.h"

namespace scancal::bench {

struct ScipyFit {
  double M = 0, N = 0;
  double cost = 0;  // sum of squares, mm^2
  double seconds = 0, peak_mb = 0;
  int calls = 0;
  std::string version, method;
};

// The points as .npy files, the start as start.json.
void WriteForScipy(const LargeData& data, const std::filesystem::path& folder);
ScipyFit RunScipy(const std::filesystem::path& script, const std::filesystem::path& folder,
                  const std::string& residual);

}  // namespace scancal::bench
