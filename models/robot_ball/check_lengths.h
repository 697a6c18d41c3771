// The lengths that a calibration is checked with.
#pragma once
#include <filesystem>
#include <string>
#include <vector>
#include "io/result.h"
#include "io/units.h"
#include "models/robot_ball/measured.h"

namespace scancal {

struct CheckFiles {
  std::filesystem::path poses, observations, distances;
};

struct CheckLengths {
  std::vector<CheckLength> lengths;
  std::vector<std::filesystem::path> files;  // of points on balls
  std::vector<std::string> warnings;
};

// distances: columns ball_a, ball_b, distance[, u]; the others as in the calibration. Every station that saw both balls
// of a pair gives one length of it, as ten positions of a scale give ten errors: from the first pose that saw ball_a
// and the last other one that saw ball_b, for two poses test the robot and one tests the scanner alone; from one pose
// if it alone saw both, which is warned of. Balls of a check need not be those of the artifact: SeenBall::sphere counts
// the names of this table and means nothing outside. Refused: a pair that no station saw; lengths that are off by half
// and more, in the scanner's own frame: another unit, or other balls.
Result<CheckLengths> ReadCheck(const CheckFiles& paths, const std::filesystem::path& folder,
                               const std::vector<Link>& links, const Units& units, double ball_diameter);

}  // namespace scancal
