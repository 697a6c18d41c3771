// Whether a robot's poses can determine what is asked of them.
#pragma once
#include <string>
#include <vector>
#include "io/result.h"
#include "models/robot_ball/measured.h"

namespace scancal {

// Refused: poses that do not turn, each station against itself (a hand-eye translation is then absorbed by the pose of
// the artifact); stations that were all seen once; a station with less than three balls in all its poses, whose pose is
// open; flange poses that are no robot's reach. Warned of: poses that turn about one axis only, a station seen once,
// poses with less than three balls. where: the table of the poses, for messages.
Result<void> CheckPlausible(const RobotData& data, const std::string& where, std::vector<std::string>* warnings);

}  // namespace scancal
