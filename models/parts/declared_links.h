// What a dataset.yaml says of all links of a robot.
#pragma once
#include <vector>
#include "io/dataset.h"
#include "models/parts/chain.h"

namespace scancal {

// robot: {links: [{theta: 0, d: 333, a: 0, alpha: -90, beta: 0}, ...]}, base to flange, in the data set's units; theta
// and beta are 0 where they are not given.
std::vector<Link> ReadLinks(YamlMap top, const Units& units);

// parameters: {links: {estimate: 0, u_length: 0.5, u_angle: 0.1}}, in mm and rad.
struct LinkSetting {
  bool hold = false;                 // all of them; what is named singly stands
  double u_length = 0, u_angle = 0;  // of the prior of each that is estimated by default; 0: none
};
LinkSetting ReadLinkSetting(const Dataset& dataset);

}  // namespace scancal
