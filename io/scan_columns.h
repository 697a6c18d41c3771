// Which columns of a scan file are wanted, and in which unit they stand there.
#pragma once
#include <string>
#include <vector>
#include "io/result.h"
#include "io/scan_reader.h"

namespace scancal {

struct ChosenColumn {
  std::string name;   // as wanted: "y"
  size_t index = 0;   // in the file, 0-based
  double factor = 1;  // times this: mm, rad
};

// The wanted columns that the file has, in the order of format.columns. `place`: of the header, for complaints:
// "left.csv:1". A required one that is missing, or one that is there twice ("y" and "y_mm"): an error.
Result<std::vector<ChosenColumn>> ChooseColumns(const ScanFormat& format, const std::vector<std::string>& found,
                                                const std::string& place);

// The unit of `wanted` if `found` is its name, plain ("y") or with a unit ("y_mm"); else empty.
std::optional<double> MatchColumn(const ScanColumn& wanted, std::string_view found, const Units& units);

}  // namespace scancal
