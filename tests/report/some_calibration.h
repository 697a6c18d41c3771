// Results to report.
#pragma once
#include <cmath>
#include <limits>
#include <tuple>
#include "solver/calibration.h"

namespace scancal {

inline Calibration SomeCalibration() {
  Calibration c;
  c.model = "turntable";
  c.name = "a plate";
  c.residual = "depth";
  for (const auto& [name, unit, role, value, u] : {std::tuple{"M", Unit::kMm, Role::kEstimate, 123.0021, 0.011},
                                                   {"N", Unit::kMm, Role::kEstimate, 409.1, 0.02},
                                                   {"tilt_x", Unit::kRad, Role::kConsider, 1e-3, 2e-4},
                                                   {"tilt_y", Unit::kRad, Role::kHold, 0.0, 0.0}}) {
    Parameter& p = c.parameters.emplace_back();
    p.name = name;
    p.unit = unit;
    p.role = role;
    p.value = value;
    p.u = u;
    p.k = 2;
    p.U = 2 * u;
    p.dof = 100;
  }
  c.estimated = {"M", "N"};
  c.covariance = Eigen::Matrix2d{{1.21e-4, 3e-5}, {3e-5, 4e-4}};
  c.grid = {{"M", "N"}, {123, 409}, 0.05, 1, 651};
  c.targets = {{"left",
                800,
                3,
                {{"off the line of their profile", 2}, {"off the plane of their target", 5}},
                {{"normal", {0, -1, 0}}, {"distance", {480}}},
                0.05,
                {{0, 1, 2}, {1, 0.25, 0}, 1.5, false, 0.04, 8, {1, 700, 0}, 2, 3},
                {},
                {}}};
  c.sigma = 0.05;
  c.inputs = {{"left.csv", "abc"}};
  c.command = "scancal refine data";
  c.version = "0.1.0";
  c.converged = true;
  return c;
}

inline Calibration WithBudgetAndVolume() {
  Calibration c = SomeCalibration();
  c.budget = {{{"encoder_jitter"}, 'A', Unit::kRad, 2e-5, {}, {0.01, 0.015}, {0.8, 0.6}, 100},
              {{"tilt_x"}, 'B', Unit::kRad, 2e-4, {3.5, -1.25}, {7e-4, 2.5e-4}, {0.2, 0.4}, INFINITY}};
  c.volume = {{"alpha", "y", "X", "Y", "Z", "U_x", "U_y", "U_z", "U_max"},
              {Unit::kRad, Unit::kMm, Unit::kMm, Unit::kMm, Unit::kMm, Unit::kMm, Unit::kMm, Unit::kMm, Unit::kMm},
              {{-0.25, 40, 1, 2, 3, 0.01, 0.02, 0.03, 0.031}, {0.25, 160, 4, 5, 6, 0.1, 0.2, 0.3, 0.312}},
              {}};
  return c;
}

inline MonteCarloSummary SomeMonteCarlo() {
  MonteCarloSummary summary;
  summary.trials = 10'000;
  summary.failed = 3;
  summary.seed = 18'446'744'073'709'551'615u;
  summary.parameters = {
      {"M", 123.0023, 0.0112, 122.9801, 123.0239, 122.9801, 123.0241, 5e-3, "PASS", {122, 123, 124}, {4000, 5997}},
      {"N", 409.1, 0.02, 409.06, 409.14, 409.06, std::numeric_limits<double>::infinity(), 5e-3, "FAIL", {}, {}}};
  return summary;
}

}  // namespace scancal
