// Scan files read to their end, for tests.
#pragma once
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>
#include "io/scan.h"
#include "io/units.h"
#include "tests/io/temporary_folder.h"

namespace scancal {

struct Scan {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;
  int64_t missing = 0;
  std::string error;  // empty: none
  std::string description;
  bool heights = false;
  // Of a column; empty if there is none.
  std::vector<double> operator[](std::string_view name) const {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? std::vector<double>() : columns[static_cast<size_t>(found - names.begin())];
  }
};

inline Scan ReadAll(const ScanFormat& format) {
  Scan scan;
  auto reader = ScanReader::Open(format);
  if (!reader.ok()) {
    scan.error = reader.error().message;
    return scan;
  }
  scan.description = (*reader)->Describe();
  scan.heights = (*reader)->gives_heights();
  ScanBatch batch;
  for (;;) {
    const auto more = (*reader)->Next(&batch);
    scan.missing = (*reader)->missing();
    if (!more.ok()) scan.error = more.error().message;
    if (!more.ok() || !*more) return scan;
    scan.names = batch.names;
    scan.columns.resize(batch.columns.size());
    for (size_t i = 0; i < batch.columns.size(); ++i) {
      scan.columns[i].insert(scan.columns[i].end(), batch.columns[i].begin(), batch.columns[i].end());
    }
  }
}

// Of files as a turntable's data set declares them.
class ScanFileTest : public ::testing::Test {
 protected:
  ScanFormat Format(const std::string& name, std::string_view contents) {
    ScanFormat format;
    format.path = folder_.Write(name, contents);
    format.columns = {{"angle", Dimension::kAngle},         {"bearing", Dimension::kAngle, false},
                      {"y", Dimension::kLength, false},     {"z", Dimension::kLength, false},
                      {"range", Dimension::kLength, false}, {"profile", Dimension::kNone, false},
                      {"time", Dimension::kNone, false}};
    format.one_of = {{"y", "z"}, {"bearing", "range"}};
    return format;
  }
  // Profiles at `start` and `step` rad.
  static LoggedAngle Steps(double start, double step) {
    return {.rad_per_count = step, .is_step = true, .start = start, .first = {}, .echo = "steps"};
  }
  // Counts of 0.5 rad.
  static LoggedAngle Counts(const std::string& column) {
    return {.column = column, .rad_per_count = 0.5, .first = {}, .echo = "counts"};
  }
  // Of the only file.
  std::string Place(const std::string& place) const {
    return (folder_.path() / folder_.Names().front()).string() + place;
  }

  TemporaryFolder folder_;
};

}  // namespace scancal
