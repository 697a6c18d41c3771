// Scan files, read in batches of points with named columns in mm and rad.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include "io/result.h"
#include "io/units.h"

namespace scancal {

struct ScanColumn {
  std::string name;  // "angle", "y"
  Dimension dimension = Dimension::kNone;
  bool required = true;  // optional ones are absent from the batch if the file has none
};

struct WideLayout {            // one profile per line
  std::string value;           // what the cells hold: "y" | "range"
  std::string across;          // what runs along the line: "z" (with y) | "bearing" (with range)
  int angle_column = 1;        // 1-based
  int first_column = 2;        // first cell, 1-based
  double start = 0, step = 1;  // of `across`, declared unit
};

struct ScanFormat {  // how one scan file is to be read, as the data set declares it
  std::filesystem::path path;
  Units units;                                   // a unit suffix of a column's name (angle_deg, y_mm) wins
  std::vector<ScanColumn> columns;               // wanted; others in the file are ignored
  std::vector<std::vector<std::string>> one_of;  // of these groups the file needs one whole; empty: any will do
  std::vector<std::string> npy_columns;          // names of the columns of a .npy
  std::optional<double> invalid;                 // this value, as it stands in the file, is a missing point
  std::optional<WideLayout> layout;
  std::optional<std::pair<int64_t, int64_t>>
      lines;  // keep only these lines of the file (rows of a .npy), 1-based, inclusive
};

struct ScanBatch {                           // equally long columns, in the order of `names`
  std::vector<std::string> names;            // the columns found; wide files add "profile" (the line's number)
  std::vector<std::vector<double>> columns;  // mm, rad; of dimension kNone as in the file
  size_t size() const { return columns.empty() ? 0 : columns.front().size(); }
  int Find(std::string_view name) const;  // index, or -1
};

// CSV (header, comma), wide CSV (layout), .npy (float64 | float32, C order, shape (points, columns)); by layout, then
// extension. Missing points (empty, nan, `invalid` in a wanted column) are left out and counted. inf, text, overflow, a
// wrong number of fields are errors: "left.csv:1042:8: y: found "12.3.4", expected a number".
class ScanReader {
 public:
  static Result<ScanReader> Open(const ScanFormat& format);
  ScanReader(ScanReader&&) noexcept;
  ScanReader& operator=(ScanReader&&) noexcept;
  ~ScanReader();
  // Up to about 100,000 points; empty at the end of the file.
  Result<bool> Next(ScanBatch* batch);  // false: nothing more
  int64_t missing() const;              // so far
  int64_t bytes_read() const;           // so far, for a progress bar
  int64_t bytes_total() const;

 private:
  class Impl;
  explicit ScanReader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace scancal
