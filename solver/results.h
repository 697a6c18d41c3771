// What the other commands find, as plain values: a comparison of methods, points propagated, the selftest.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>
#include "solver/problem.h"
#include "solver/sentence.h"
#include "solver/uncertainty/measurand.h"

namespace scancal {

struct ComparisonColumn {
  std::string name;      // with its unit: "M/mm"
  int digits = 3;        // significant ones where there is no u; 0: a whole number
  bool is_time = false;  // of computing: not the same twice
};

struct ComparisonCell {
  std::optional<double> value;  // in the unit of the column; none: does not apply
  double u = 0;                 // standard uncertainty; 0: not known
};

struct ComparisonRow {
  Sentence method;
  std::vector<ComparisonCell> cells;  // one a column; none: the method was left out, as the note says
  Sentence note;                      // minimum on the edge, no convergence
};

struct Comparison {
  std::vector<ComparisonColumn> columns;
  std::vector<ComparisonRow> rows;
};

struct PropagatedPoint {
  std::vector<double> reading;       // what the scanner shows
  Eigen::Vector3d position;          // in the frame of the calibration
  MeasurandUncertainty uncertainty;  // of the position; without the noise of the reading itself
};

struct PropagatedDistance {
  size_t from = 0, to = 0;  // points
  double value = 0;
  MeasurandUncertainty uncertainty;
};

struct Propagation {
  std::vector<std::string> reading;  // names of its numbers
  std::vector<Unit> units;           // of its numbers
  std::vector<PropagatedPoint> points;
  std::vector<PropagatedDistance> distances;
  std::vector<std::string> notes;     // what the figures do not hold
  std::vector<std::string> warnings;  // worth knowing
};

// Of the quantity that comes closest to failing: -log10 of its relative error, at most what the known answer has.
struct Digits {
  double reached = 0, required = 0;
  bool enough() const { return reached >= required; }
};

struct SelftestRow {
  std::string name = {};
  std::string level = {};                // of difficulty, in the words of its source
  int observations = 0, parameters = 0;  // of a fit
  Digits values = {}, deviations = {};   // estimates, and their standard deviations
  int iterations = 0;
  std::string note = {};
  bool pass() const { return values.enough() && deviations.enough(); }
};

struct Selftest {
  std::vector<SelftestRow> rows;
  bool ok() const {
    return std::all_of(rows.begin(), rows.end(), [](const SelftestRow& row) { return row.pass(); });
  }
};

}  // namespace scancal
