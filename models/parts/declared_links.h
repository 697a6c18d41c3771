// What a dataset.yaml says of all links of a robot.
#pragma once
#include <span>
#include <vector>
#include "io/dataset.h"
#include "models/parts/chain.h"

namespace scancal {

// Reach of any robot, mm: outside of it the unit is another.
inline constexpr double kLeastReach_mm = 20, kLargestReach_mm = 20'000;

// robot: {links: [{theta: 0, d: 333, a: 0, alpha: -90, beta: 0}, ...]}, base to flange, in the data set's units; theta
// and beta are 0 where they are not given. None without `robot:`. Complains of units that no arm can have.
std::vector<Link> ReadLinks(YamlMap top, const Units& units);

// parameters: {links: {estimate: 0, u_length: 0.5, u_angle: 0.1}}, in mm and rad.
struct LinkSetting {
  bool hold = false;                 // all of them; what is named singly stands
  double u_length = 0, u_angle = 0;  // of the prior of each that is estimated by default; 0: none
};
LinkSetting ReadLinkSetting(const Dataset& dataset);
void SetLinks(const LinkSetting& setting, std::span<Quantity> links);

}  // namespace scancal
