// The table of what the scanner saw: centres of balls, or points on them.
#pragma once
#include <filesystem>
#include <string>
#include <vector>
#include "io/table.h"
#include "models/robot_ball/measured.h"

namespace scancal {

struct SeenCentre {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();      // in the scanner's frame, mm
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of it, mm^2; zero: not said
};

struct Observations {
  Table table;
  std::vector<SeenCentre> seen;              // one a row
  bool fitted = false;                       // to points
  std::vector<std::filesystem::path> files;  // of points
  std::vector<std::string> warnings;
  const std::string& Pose(size_t row) const { return table.Text("pose", row); }
  const std::string& Ball(size_t row) const { return table.Text("ball", row); }
};

// Columns pose, ball and x, y, z[, u], or file: points on that ball (columns x, y, z; its path from `folder`), through
// which a sphere is laid, of radius ball_diameter / 2 or, if that is 0, a free one. lengths in the declared unit.
Result<Observations> ReadObservations(const std::filesystem::path& path, const std::filesystem::path& folder,
                                      const Units& units, double ball_diameter);

}  // namespace scancal
