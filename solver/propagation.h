// What a user measures with a calibrated scanner, as plain values. Lengths mm, angles rad.
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>
#include "solver/problem.h"
#include "solver/uncertainty/measurand.h"

namespace scancal {

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

}  // namespace scancal
