// A robot's links from a URDF, and back.
#pragma once
#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>
#include "io/urdf.h"
#include "models/chain/chain.h"

namespace scancal {

// base_from_flange(q) = base_from_first * link_1(q_1) .. link_n(q_n), the flange where the joints' tip is; mm.
struct UrdfLinks {
  std::vector<Link> links;
  Eigen::Isometry3d base_from_first = Eigen::Isometry3d::Identity();  // z along the first axis
  std::vector<std::string> joints;                                    // names of those that turn
};

// Axis by axis: the common normal of two neighbours gives theta, d, a and alpha; between parallel ones d is zero, and
// beta takes what they are not parallel by (Hayati and Mirmirani, J. Robot. Syst. 2, 1985, 397). The first axis keeps
// the base where it is one of its z. Five numbers hold a tip on the last axis, as a tool0 or a flange is, but not every
// frame: an Error. An Error, too, without a joint that turns. name: of the file, for messages.
Result<UrdfLinks> LinksOfUrdf(const std::vector<UrdfJoint>& joints, const std::string& name);

// base_from_tip of a URDF's joints at these angles of those that turn, rad; mm.
Eigen::Isometry3d BaseFromTip(const std::vector<UrdfJoint>& joints, const std::vector<double>& angles);

// A URDF of these links: joints that turn without limits, which nobody measured, a link "flange", and further links on
// it by their name, flange_from_it in mm. notes: of what it leaves out. Round-trip digits.
std::string UrdfOf(const std::string& robot, const UrdfLinks& arm,
                   const std::map<std::string, Eigen::Isometry3d>& on_flange, const std::vector<std::string>& notes);

}  // namespace scancal
