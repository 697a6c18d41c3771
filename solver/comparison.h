// Several methods on the same data, as a plain value.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace scancal {

struct ComparisonRow {
  std::string method;
  std::vector<double> values;            // per Comparison::parameters, mm or rad
  std::vector<std::optional<double>> u;  // standard uncertainty; none for a grid
  std::optional<double> quantisation;    // of a grid: step / sqrt(12), mm
  double S = 0;                          // the search's objective at the values, mm
  double rms = 0;                        // of the distance that all methods make small, mm
  std::optional<double> held_out_rms;    // of each target with the values found without it, pooled, mm
  double effort = 0;                     // nodes of a grid, iterations of a refinement
  bool is_grid = false;
  double seconds = 0;
  std::string note;  // minimum on the edge, no convergence
};

struct Comparison {
  std::vector<std::string> parameters;  // "M", "N", "tilt_x", "tilt_y"
  std::vector<bool> is_angle;
  std::vector<ComparisonRow> rows;  // the last one is the reference
};

}  // namespace scancal
