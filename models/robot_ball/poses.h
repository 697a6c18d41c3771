// The table of a robot's poses.
#pragma once
#include <filesystem>
#include <string>
#include <unordered_map>
#include <vector>
#include "io/table.h"
#include "models/robot_ball/measured.h"

namespace scancal {

struct PoseTable {
  struct Place {  // of a pose
    size_t station, view, row;
  };
  Table table;
  std::vector<Station> stations;  // in the order of the file, as are their views; none has balls yet
  std::unordered_map<std::string, Place> places;
  RobotBall::View& View(const Place& place) { return stations[place.station].views[place.view]; }
};

// Columns station, pose and q1 .. qn, one a link; without links x, y, z, qx, qy, qz, qw: the flange in the base. Joint
// angles beyond two turns, or all of some degrees only, are of the other unit and refused, as are quaternions that are
// not normalised and a pose that is named twice.
Result<PoseTable> ReadPoses(const std::filesystem::path& path, const std::vector<Link>& links, const Units& units);

}  // namespace scancal
