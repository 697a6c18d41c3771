// Planes that grow over one sweep of a range image.
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>
#include "models/turntable/range_image.h"

namespace scancal::turntable {

struct GrownPlane {
  std::vector<int32_t> points;                        // in RangeImage, ascending
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  // in the table frame, n . P = distance
  double distance = 0;                                // mm
  double sigma = 0, rms = 0;                          // along depth, robust and plain; mm
  double cosine = 1;                                  // of the incidence, the middle one
};

struct GrownPlanes {
  std::vector<GrownPlane> planes;
  int bent = 0, edge_on = 0;  // refused
};

// slack: by how much M and N of `system` may be wrong, mm, one standard deviation; 0: each is what it is.
GrownPlanes GrowPlanes(const RangeImage& image, size_t sweep, const System& system, const std::array<double, 2>& slack);

}  // namespace scancal::turntable
