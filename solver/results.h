// What the other commands find, as plain values: a comparison of methods, points propagated, the selftest.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>
#include "solver/problem.h"
#include "solver/sentence.h"
#include "solver/uncertainty/conformity.h"
#include "solver/uncertainty/measurand.h"

namespace scancal {

struct ComparisonColumn {
  std::string name;      // with its unit: "M/mm"
  int digits = 3;        // significant ones where there is no u; 0: a whole number
  bool is_time = false;  // of computing: not the same twice
  bool detail = false;   // shown where there is room
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

struct ScaleFound {
  double value = 0, u = 0, U = 0;
};

struct Propagation {
  std::vector<std::string> reading;  // names of its numbers
  std::vector<Unit> units;           // of its numbers
  std::vector<PropagatedPoint> points;
  std::vector<PropagatedDistance> distances;
  std::vector<std::string> notes;     // what the figures do not hold
  std::vector<std::string> warnings;  // worth knowing
};

// A feature of known size, measured with a calibrated scanner; mm.
struct VerifiedFeature {
  std::string name, at;  // features of one name have one reference; where it was seen
  std::string kind;      // "diameter", "distance", "step"
  double nominal = 0, measured = 0;
  double u_calibration = 0, u_noise = 0, u_reference = 0;
  double u = 0, dof = 0, U = 0, E_n = 0;  // of the deviation
  double form = 0;                        // rms of the points' distances from the fitted shape
  size_t points = 0, set_aside = 0;
  std::optional<Conformity> conformity;  // where a tolerance is given
  double deviation() const { return measured - nominal; }
  bool out() const { return std::abs(E_n) > 1 || (conformity && conformity->decision == Decision::kReject); }
};

struct Verification {
  std::vector<VerifiedFeature> features;
  // Of depth, from all deviations: true = shown (1 + scale); the calibration does not know it.
  std::optional<ScaleFound> scale;
  std::vector<std::string> notes;
  bool out() const {
    return std::any_of(features.begin(), features.end(), [](const VerifiedFeature& f) { return f.out(); });
  }
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
