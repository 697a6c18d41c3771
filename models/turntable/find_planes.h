// The placements of an uncropped scan, proposed: planes that grow over its range image.
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>
#include "models/turntable/range_image.h"

namespace scancal::turntable {

struct FoundPlane {
  int number = 0;  // the same for one plane in several sweeps of a scan
  size_t sweep = 0;
  std::vector<int32_t> points;  // in RangeImage, ascending by number in the file
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();
  double rms = 0;                           // along depth (a lidar's range) from the plane, mm
  double incidence = 0;                     // between the line of sight and the normal, the middle one; rad
  std::array<double, 2> alpha{}, across{};  // from, to; rad, mm
  int32_t profiles = 0;
};

struct PlanesOfScan {
  std::vector<FoundPlane> planes;  // by number, then by sweep
  int bent = 0, edge_on = 0;       // regions that were refused: curved or creased; within 15 degrees of edge-on
  double tolerance = 0;            // along depth, of the middle plane; mm
};

struct FoundPlanes {
  std::vector<PlanesOfScan> scans;
  System system;         // as which the planes were found
  bool refined = false;  // M and N are those that these planes tell; else the declared ones
};

// Proposes planes in all scans, from M and N that are known to lie in `declaration`'s search. Deterministic.
//
// Blocks of cells that are flat along depth are seeds, the flattest first. A plane is fitted to a seed by depth, with M
// and N of its own within the box; cells connected to it whose depth is within 4 sigma of the plane join, sigma being
// the plane's own; it is fitted anew, until nothing changes. Blocks that are off on average leave, then two cells along
// every edge (of matter, not of a missing point), where a beam sees two things. A region whose large parts are off by
// more than half of sigma is bent and is refused, as is one seen within 15 degrees of edge-on. Neighbours in one sweep
// that are one plane are merged; sweeps stay apart. From all of them M and N follow, as they do in a calibration; with
// these it is done again, first nearly fixed, then fixed.
FoundPlanes FindPlanes(const std::vector<RangeImage>& images, const Declaration& declaration, const Model& model,
                       const std::function<void(double)>& progress);

// The points of a plane, as ReadScan would have read them.
RawScan ScanOf(const RangeImage& image, const FoundPlane& plane, const std::string& name);

// "plane 1", or of several sweeps "plane 1 up", "plane 1 down", "plane 1 up 2".
std::string NameOf(const RangeImage& image, const FoundPlane& plane);

}  // namespace scancal::turntable
