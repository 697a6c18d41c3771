// What the readers of the formats have in common.
#pragma once
#include <cstdint>
#include <limits>
#include <memory>
#include "io/number.h"
#include "io/result.h"
#include "io/scan_reader.h"

namespace scancal {

class ScanSource {  // see ScanReader
 public:
  virtual ~ScanSource() = default;
  virtual Result<bool> Next(ScanBatch* batch) = 0;
  virtual int64_t bytes_read() const = 0;
  virtual int64_t bytes_total() const = 0;
  int64_t missing() const { return missing_; }

 protected:
  static constexpr size_t kBatchPoints = 100'000;
  int64_t missing_ = 0;
};

Result<std::unique_ptr<ScanSource>> OpenCsv(const ScanFormat& format);
Result<std::unique_ptr<ScanSource>> OpenWideCsv(const ScanFormat& format);
Result<std::unique_ptr<ScanSource>> OpenNpy(const ScanFormat& format);

// The lines of the file that are wanted.
struct LineRange {
  int64_t first = 1, last = std::numeric_limits<int64_t>::max();
  explicit LineRange(const ScanFormat& format) {
    if (format.lines) std::tie(first, last) = *format.lines;
  }
};

// The value of a missing point; without one, nan, which equals no number.
inline double InvalidValue(const ScanFormat& format) {
  return format.invalid.value_or(std::numeric_limits<double>::quiet_NaN());
}

// left.csv:1042:8: y: found "12.3.4", expected a number
Error WrongCell(const std::string& place, const std::string& name, NumberKind kind, const std::string& found);

// "left.csv: no points": the file has none, or the wanted lines have none.
Error NoPoints(const ScanFormat& format, int64_t lines_in_file);

}  // namespace scancal
