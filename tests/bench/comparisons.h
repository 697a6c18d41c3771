// One function per comparison; each adds its lines to the table.
#pragma once
#include <filesystem>
#include "tests/bench/measure.h"
#include "tests/bench/scene.h"

namespace scancal::bench {

struct LargeData {
  std::vector<SimulatedPlacement> points;
  std::vector<Placement> placements;  // the same, compressed
  Start start;
};

// The published search: node by node and point by point against the plane storey.
void CompareGrid(const LargeData& data, Table* table);
// The joint refinement with both residuals against Ceres with one residual per point, and against scipy if
// `scipy_script` is given: time, memory, answer. folder: for the points that are handed over.
void CompareJoint(const LargeData& data, const std::filesystem::path& scipy_script, const std::filesystem::path& folder,
                  Table* table);
// The robot's refinement against scipy, if `scipy_script` is given, and for more poses. folder: for what is handed
// over.
void CompareRobot(const std::filesystem::path& scipy_script, const std::filesystem::path& folder, Table* table);
// Everything after reading, for more points on the same profiles, and for more profiles.
void CompareScaling(Table* table);
// A trial of the Monte Carlo against a refinement.
void CompareMonteCarlo(Table* table);
// Compressing points in memory against a sum of the same bytes.
void CompareCompression(Table* table);
// Reading CSV against a bare from_chars loop.
void CompareReading(const std::filesystem::path& folder, Table* table);

}  // namespace scancal::bench
