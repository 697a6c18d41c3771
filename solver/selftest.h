// The program's own proof of its arithmetic, as a plain value.
#pragma once
#include <algorithm>
#include <string>
#include <vector>

namespace scancal {

// Of the quantity that comes closest to failing: -log10 of its relative error, at most what the known answer has.
struct Digits {
  double reached = 0, required = 0;
  bool enough() const { return reached >= required; }
};

struct SelftestRow {
  std::string name = {};
  std::string level = {};                // of difficulty, in the words of its source
  int observations = 0, parameters = 0;  // of a fit
  Digits values = {}, deviations = {};   // estimates, and their standard deviations
  int iterations = 0;
  std::string note = {};
  bool pass() const { return values.enough() && deviations.enough(); }
};

struct Selftest {
  std::vector<SelftestRow> rows;
  bool ok() const {
    return std::all_of(rows.begin(), rows.end(), [](const SelftestRow& row) { return row.pass(); });
  }
};

}  // namespace scancal
