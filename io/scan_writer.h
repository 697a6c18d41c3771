// The points of a scan, written as ScanReader reads them.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>
#include "io/result.h"
#include "io/scan.h"

namespace scancal {

// By extension: .csv (round-trip digits), .npy (float64, shape (points, columns)), .ply and .pcd (binary, double).
// Lengths in mm and angles in rad, which the names of the columns say: angle_rad, y_mm. Streaming.
class ScanWriter {
 public:
  // columns: as the reader's, for their dimensions. An unknown extension: an error that lists them.
  static Result<std::unique_ptr<ScanWriter>> Create(const std::filesystem::path& path,
                                                    const std::vector<ScanColumn>& columns);
  virtual ~ScanWriter() = default;
  virtual Result<void> Write(const ScanBatch& batch) = 0;  // each with the columns of the first
  virtual Result<void> Commit() = 0;
  const std::vector<std::string>& names() const { return names_; }  // in the file, after the first batch
  int64_t points() const { return points_; }

 protected:
  std::vector<std::string> names_;
  int64_t points_ = 0;
};

}  // namespace scancal
