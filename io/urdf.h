// Robots in the Unified Robot Description Format.
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>
#include "io/result.h"

namespace scancal {

// A joint, seen from the frame of the link before it: child_from_parent is a shift by xyz, a turn by rpy (about fixed
// x, y, z, in this order), then a turn by the joint's angle about `axis`. m, rad.
struct UrdfJoint {
  std::string name, child;  // of itself, of the link that it carries
  bool turns = false;       // revolute or continuous; else fixed
  std::array<double, 3> xyz = {}, rpy = {}, axis = {1, 0, 0};
};

// The joints between two links of the robot, from `base` (empty: the root) to `tip`. Refused: text that is no URDF
// (xacro among it), joints that slide or mimic others between the two, no tip. name: of the file, for messages.
Result<std::vector<UrdfJoint>> ReadUrdf(std::string_view text, const std::string& name, const std::string& base,
                                        const std::string& tip);

}  // namespace scancal
