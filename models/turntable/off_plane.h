// Profiles that do not lie on the plane of their placement.
#pragma once
#include <vector>
#include "models/turntable.h"
#include "models/turntable/placement.h"

namespace scancal {

// Per profile whether it is off: farther (rms) from the least-median plane than six times the median distance. Up to 40
// % of the profiles may see something else. At (M, N) near the truth; fewer than six profiles are never judged.
std::vector<bool> OffPlane(const std::vector<Profile>& profiles, const TurntablePose& pose);

}  // namespace scancal
