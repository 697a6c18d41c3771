// A simulated robot as a data set on disk.
#pragma once
#include <filesystem>
#include "io/result.h"
#include "models/robot_ball/simulate.h"

namespace scancal {

// folder/dataset.yaml, poses.csv, balls.csv, artifact.csv, check_poses.csv, check_balls.csv, check_distances.csv and
// truth.json. Lengths are rounded to 1 nm, joint angles to 1e-9 deg. declare: noise and repeatability are written as
// influences. Refuses a scene with a count below one or a negative noise.
Result<void> WriteSimulatedRobot(const RobotScene& scene, bool declare, const std::filesystem::path& folder);

}  // namespace scancal
