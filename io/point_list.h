// Points that are given by a few numbers each, typed or as a table.
#pragma once
#include <filesystem>
#include <string>
#include <vector>
#include "io/result.h"
#include "io/scan_reader.h"

namespace scancal {

struct PointRequest {
  std::string typed;           // "10,50,-20; 12,50,-20": in the order of the columns
  std::filesystem::path file;  // one point a line, as a scan file has them; empty: none
  Units units;                 // of the typed ones, and of columns without a unit in their name
};

// The typed ones first; one number per column, mm and rad. An Error without any, or where a number is missing.
Result<std::vector<std::vector<double>>> ReadPoints(const PointRequest& request,
                                                    const std::vector<ScanColumn>& columns);

Result<Units> ParseUnits(const std::string& text);  // "mm,deg": one of length, one of angle

}  // namespace scancal
