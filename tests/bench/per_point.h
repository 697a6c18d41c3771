// The joint fit as one writes it without compression: Ceres, one automatically differentiated residual per point.
#pragma once
#include <vector>
#include "tests/bench/scene.h"

namespace scancal::bench {

struct PerPointFit {
  double M = 0, N = 0;
  double cost = 0;             // sum of squares, mm^2
  std::vector<double> planes;  // three per placement: steps along e1 and e2 before normalisation, distance
  double build_s = 0, solve_s = 0;
  int iterations = 0;
};

PerPointFit FitPerPoint(const std::vector<SimulatedPlacement>& points, const Start& start,
                        turntable::Model::Residuals residuals);

// Gauss-Newton steps by QR over all points: Ceres' normal equations leave the last digits undetermined.
void Polish(const std::vector<SimulatedPlacement>& points, const Start& start, turntable::Model::Residuals residuals,
            PerPointFit* fit);

}  // namespace scancal::bench
