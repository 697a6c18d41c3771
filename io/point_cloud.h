// Point clouds, written as they come.
#pragma once
#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include "io/result.h"

namespace scancal {

// By extension: .ply (binary little endian; double x, y, z; int scan), .csv (x_mm,y_mm,z_mm,scan; round-trip digits),
// .npy (float64, shape (points, 3)). Streaming: memory does not grow with the number of points.
class PointCloudWriter {
 public:
  virtual ~PointCloudWriter() = default;
  virtual Result<void> Write(std::span<const std::array<double, 3>> points_mm, int scan) = 0;
  virtual Result<void> Commit() = 0;
};

Result<std::unique_ptr<PointCloudWriter>> CreatePointCloud(
    const std::filesystem::path& path);  // unknown extension: an error that lists them

}  // namespace scancal
