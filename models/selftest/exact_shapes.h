// Orthogonal planes and geometric spheres through small point sets whose least squares answers are known to 40 digits.
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>
#include "solver/results.h"

namespace scancal {

struct ExactShape {
  enum Kind { kPlane, kSphere };
  std::string name;
  Kind kind = kPlane;
  double known_radius = 0;  // mm; 0: estimated
  std::vector<Eigen::Vector3d> points;
  std::vector<std::string> values;      // plane: n, d > 0 of n . p = d; sphere: centre, radius unless known
  std::vector<std::string> deviations;  // of the values
};

std::vector<ExactShape> ExactShapes();  // computed by scripts/selftest_digits

SelftestRow Check(const ExactShape& shape);

}  // namespace scancal
