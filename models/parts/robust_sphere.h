// The sphere on which most points lie, whatever the others are.
#pragma once
#include <vector>
#include "models/parts/sphere.h"

namespace scancal {

// Farther than this many standard deviations is not on the sphere: of a normal distribution one point in 16,000.
inline constexpr double kOffSphere = 4;

struct RobustSphere {
  SphereFit fit;          // of the points that are not off
  std::vector<bool> off;  // per point
  int set_aside = 0;      // of them
};

// Least median of squares over spheres through a few points drawn from a fixed seed, then FitSphere of the points that
// are not off, until these stay the same. Up to 40 % of the points may lie elsewhere: on the stem, the floor, at edges.
// Fewer than eight points are never off.
RobustSphere FitRobustSphere(std::span<const Eigen::Vector3d> points, const SphereChoice& choice = {});

}  // namespace scancal
