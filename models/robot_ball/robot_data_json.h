// What a robot saw, as calibration.json keeps it.
#pragma once
#include <string>
#include "io/json_file.h"
#include "io/result.h"
#include "models/robot_ball/declaration.h"

namespace scancal {

Json RobotDataToJson(const RobotDeclaration& declaration);
// data, u_of_spheres, centres_have_u and warnings; every number as it was. file: for messages.
Result<RobotDeclaration> RobotDataFromJson(const Json& data, const std::string& file);

}  // namespace scancal
