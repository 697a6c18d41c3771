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

// Poses that are written twice, under other names or as a station of their own, bring no information: they are removed
// and named in a warning. Copies have the same joints and centres that are nearer than independent measurements of this
// noise and resolution would be by chance (a scanner of coarse steps repeats itself honestly).
void DropCopies(const std::string& where, Measurements* data, std::vector<Sentence>* warnings);

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

// The data without poses that contradict the others by far (kept out by consensus, before any fit), and the hand-eye
// that the rest agree on. An Error where they agree on none: the usual mistakes are tried on the data (another order of
// a quaternion, an inverse, a joint's sign, zero or coupling, observations of a neighbour), and the one that fits is
// named with how well the poses agree before and after; none is ever applied.
struct Screened {
  Measurements data;
  Eigen::Isometry3d hand_eye = Eigen::Isometry3d::Identity();
  std::vector<Sentence> warnings;  // the poses set aside, by name
};
Result<Screened> Screen(const Measurements& data);

// Screen, FitJointly, and again without poses that then still lie far from where all others put them, by the rule of
// FarOff; they are named in a warning.
struct ScreenedFit {
  Measurements data;  // those that entered
  JointFit fit;
  std::vector<Sentence> warnings;
  size_t set_aside = 0;
};
Result<ScreenedFit> FitScreened(const Measurements& data, const Model& model, int max_iterations = 100,
                                bool equal_weights = false);

// Unreliable: many poses that had to be set aside (one wrong joint angle spoils links and hand-eye, and would pass as
// repeatability); known lengths that the calibration makes worse, misses by a tenth, or by more than its uncertainty,
// the noise and their own explain.
void Judge(const ScreenedFit& fitted, Calibration* result);

}  // namespace scancal::robot_ball
