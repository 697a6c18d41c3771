// The published method as printed: Zhao et al., Sensors 2021, 21, 8359, equations (7) to (15) and Algorithm 1, point by
// point.
//
// This is the baseline, kept for comparison and as the reference that the compressed search must reproduce. Where it is
// wrong it stays wrong: eq. (7) holds for M >= 0 and N + y >= 0 only, and the plane Z = A X + B Y + C cannot be
// parallel to the axis.
#pragma once
#include <Eigen/Core>
#include <vector>
#include "solver/grid_search.h"

namespace scancal::zhao_2021 {

struct Measurement {
  double alpha = 0, y = 0, z = 0;  // rad, mm, mm
};

// Eq. (7), with square root, arctangent and absolute values.
Eigen::Vector3d Transform(double M, double N, const Measurement& p);

struct Plane {  // Z = A X + B Y + C
  double A = 0, B = 0, C = 0;
};

Plane FitPlane(const std::vector<Eigen::Vector3d>& points);                   // eqs. (8)-(13)
double Rmse(const Plane& plane, const std::vector<Eigen::Vector3d>& points);  // eq. (14)

// Eq. (15): the mean of the placements' rmse at one node.
double S(double M, double N, const std::vector<std::vector<Measurement>>& placements);

// Algorithm 1, read as meant: N runs from c to d for every M, S starts at infinity.
GridResult Search(const GridBox& box, const std::vector<std::vector<Measurement>>& placements);

}  // namespace scancal::zhao_2021
