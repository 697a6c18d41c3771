// Whether the balls of a pose are those that they are said to be.
#pragma once
#include <optional>
#include <string>
#include <vector>
#include "models/robot_ball/measured.h"

namespace scancal {

struct WrongBall {
  std::string pose, ball;
  std::string sentence;  // what is wrong with it, and what it may be
};

// Compares the distances of the balls within each pose, which no robot and no hand-eye can change, with those of the
// artifact. What all distances have in common is another unit (a factor of 1000, 25.4 ...) or a mirror image: an empty
// pose and ball; else the first ball of which most distances are off by more than kOffNoises times the noise, and the
// name that would suit it. The noise is that of the best fifth of all distances. Nothing: none was found.
inline constexpr double kOffNoises = 20;
std::optional<WrongBall> FindWrongBall(const RobotData& data);

}  // namespace scancal
