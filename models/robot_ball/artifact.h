// The table of an artifact's balls.
#pragma once
#include <filesystem>
#include <vector>
#include "io/table.h"
#include "models/robot_ball.h"

namespace scancal {

struct Artifact {
  Table table;
  std::vector<RobotBall::Sphere> spheres;
  std::vector<double> u;  // of each centre's coordinates, mm; nan: not said
};

// Columns ball, x, y, z[, u], in the artifact's own frame. Two balls of one name or in one place are refused.
Result<Artifact> ReadArtifact(const std::filesystem::path& path, const Units& units);

}  // namespace scancal
