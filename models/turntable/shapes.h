// Spheres and planes in what a calibrated turntable has scanned.
#pragma once
#include <vector>
#include "models/turntable/verify.h"

namespace scancal::turntable {

// A target's points in the table frame, those on its shape, and the shape.
struct Shape {
  const SeenTarget* target;
  std::vector<Eigen::Vector3d> all;
  std::vector<size_t> on;                            // of them
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of a plane: the mean of its points
  double radius = 0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // of a plane
  size_t set_aside() const { return all.size() - on.size(); }
  const Eigen::Vector3d& At(size_t k) const { return all[on[k]]; }
};

// Robust, orthogonal. Error: the points do not determine it.
Result<Shape> SphereOf(const System& system, const SeenTarget& target);
// Least median of squares over planes through three points, then all that are within kOffSphere standard deviations.
Result<Shape> PlaneOf(const System& system, const SeenTarget& target);

}  // namespace scancal::turntable
