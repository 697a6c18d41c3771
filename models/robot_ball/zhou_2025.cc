#include "models/robot_ball/zhou_2025.h"
#include "models/robot_ball/centre_adjustment.h"
#include "models/robot_ball/distance_identification.h"
#include "models/robot_ball/virtual_point.h"

namespace scancal {

Result<RobotSetup> Zhou2025(const RobotData& data) {
  const RobotData adjusted = AdjustCentres(data);
  SCANCAL_ASSIGN_OR_RETURN(const RobotSetup first, VirtualPointHandEye(adjusted));
  return IdentifyByDistances(adjusted, first, Identified::kHandEyeAndLinks);
}

}  // namespace scancal
