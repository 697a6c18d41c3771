#include "models/robot_ball/mu_2017.h"
#include "models/robot_ball/distance_identification.h"
#include "models/robot_ball/virtual_point.h"

namespace scancal {

Result<RobotSetup> Mu2017(const RobotData& data) {
  SCANCAL_ASSIGN_OR_RETURN(const RobotSetup first, VirtualPointHandEye(data));
  return IdentifyByDistances(data, first, Identified::kHandEyeAndLinks);
}

}  // namespace scancal
