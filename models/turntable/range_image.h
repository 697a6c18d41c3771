// An uncropped scan as an image: a row a profile, a column a place along the line.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>
#include "io/result.h"
#include "io/scan.h"
#include "models/turntable/compress.h"

namespace scancal::turntable {

struct RangeImage {
  static constexpr int64_t kMostPoints = 10'000'000;  // 40 bytes each
  std::string name;                                   // of the target
  // Of each point.
  std::vector<double> y, z;          // mm
  std::vector<int32_t> row, column;  // its cell; several points may share one
  std::vector<int64_t> number;       // running number among all points of the file, from 1
  // Of each row.
  std::vector<double> alpha;  // rad, clockwise seen from +Z, without jumps of a turn
  int32_t rows = 0, columns = 0;
  double first_across = 0, pitch = 0;  // z (mm), of a lidar the bearing (rad), of column 0, and per column
  bool lidar = false;
  std::vector<int32_t> point;                       // rows x columns: the first point of the cell, or -1
  std::vector<std::pair<int32_t, int32_t>> sweeps;  // rows from, to before: where the table turns one way
  int64_t points_in_file = 0;                       // without missing ones
  std::string checksum;                             // of all of them
  int32_t At(int32_t r, int32_t c) const {
    return point[static_cast<size_t>(r) * static_cast<size_t>(columns) + static_cast<size_t>(c)];
  }
  bool Rises(size_t sweep) const {
    return alpha[static_cast<size_t>(sweeps[sweep].second - 1)] >= alpha[static_cast<size_t>(sweeps[sweep].first)];
  }
};

// A fingerprint of points as they are read (FNV-1a over 64-bit words), whatever the file's format: angle, depth and
// place along the line of each, in their order.
class PointsChecksum {
 public:
  void Add(const ScanBatch& batch);
  int64_t points() const { return points_; }
  std::string Text() const;  // 16 hexadecimal digits

 private:
  uint64_t hash_ = 0xcbf29ce484222325;
  int64_t points_ = 0;
};

// Reads what `keep` keeps. Refuses more than `most` points, and a scan that is no image (a cell a point).
Result<RangeImage> ReadRangeImage(const ScanDeclaration& scan, const Senses& senses, int64_t most,
                                  const std::function<void(double)>& progress);

// Cells and sweeps from y, z and what begins each row; across: z or bearing of each point. Points of a row may have any
// order. Sweeps of fewer than kFewestRows rows are none.
Result<void> MakeImage(const std::vector<double>& across, const std::string& file, RangeImage* image);
inline constexpr int32_t kFewestRows = 12;

}  // namespace scancal::turntable
