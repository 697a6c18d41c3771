// The robot of the simulated experiment: a six-axis arm of the KUKA KR 10 kind with the published errors.
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <vector>
#include "models/parts/chain.h"

namespace scancal {

// Nominal links of a KR 10 R1100: at q = (0, -90, 0, 0, 0, 0) degrees the upper arm stands up and the forearm points
// along +X of the base.
std::vector<Link> Kr10Links();

struct JointLimits {
  double least, most;  // rad
};
std::array<JointLimits, 6> Kr10Limits();

// Table 3 of Zhou et al. 2025, its angles read as degrees (as radians they would move the scanner by 15 mm). Link 2 has
// beta in place of d.
std::vector<Link> PublishedLinkErrors();

// flange_from_scanner as published with Table 3, made a rotation: its third row is printed without the sign that a
// right-handed frame needs. The scanner's origin lies in the middle of what it sees, its Z points back to the flange.
Eigen::Isometry3d PublishedHandEye();

// What a drawing would say of it: axes parallel to those of the flange, 265 mm along its Z.
Eigen::Isometry3d DrawnHandEye();

}  // namespace scancal
