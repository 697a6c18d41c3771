// Joint angles as robots log them: one pose a line, often without a header.
#pragma once
#include <filesystem>
#include <string>
#include <vector>
#include "io/result.h"
#include "io/units.h"

namespace scancal {

struct JointFormat {
  std::vector<std::string> columns;  // names of the columns of files without a header; empty: files have one
  Units units;                       // a unit in a column's name (q1_rad) wins
};

// The columns q1 .. qn of a CSV file, one vector a line, rad; others are ignored. Two lines or more. An Error names the
// line and column of what is no angle, and asks for the right unit if no robot turns so far or so little.
Result<std::vector<std::vector<double>>> ReadJoints(const std::filesystem::path& path, const JointFormat& format,
                                                    size_t joints);

}  // namespace scancal
