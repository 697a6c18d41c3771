// Whether the data of a robot can be right, before and after the fit.
#pragma once
#include <optional>
#include <string>
#include <vector>
#include "io/result.h"
#include "models/robot_ball/fit.h"
#include "solver/sentence.h"

namespace scancal::robot_ball {

// Refused: poses that do not turn, each station against itself (a hand-eye translation is then absorbed by the pose of
// the artifact); stations that were all seen once; a station with less than three balls in all its poses, whose pose is
// open; flange poses that are no robot's reach. Warned of: poses that turn about one axis only, a station seen once,
// poses with less than three balls. where: the table of the poses, for messages.
Result<void> CheckPoses(const Measurements& data, const std::string& where, std::vector<Sentence>* warnings);

struct WrongBall {
  std::string pose, ball;
  std::string sentence;  // what is wrong with it, and what it may be
};

// Compares the distances of the balls within each pose, which no robot and no hand-eye can change, with those of the
// artifact. What all distances have in common is another unit (a factor of 1000, 25.4 ...) or a mirror image: an empty
// pose and ball; else the first ball of which most distances are off by more than kOffNoises times the noise, and the
// name that would suit it. The noise is that of the best fifth of all distances. Nothing: none was found.
inline constexpr double kOffNoises = 20;
std::optional<WrongBall> FindWrongBall(const Measurements& data);

// Unreliable: a pose whose balls lie far from where all others put them, by name (one wrong joint angle spoils links
// and hand-eye, and would pass as repeatability); known lengths that the calibration makes worse, or misses by a tenth.
void Judge(const Measurements& data, const JointFit& fit, Calibration* result);

}  // namespace scancal::robot_ball
