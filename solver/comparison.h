// Several methods on the same data, as a plain value.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace scancal {

struct ComparisonColumn {
  std::string name;      // with its unit: "M/mm"
  int digits = 3;        // significant ones where there is no u; 0: a whole number
  bool is_time = false;  // of computing: not the same twice
};

struct ComparisonCell {
  std::optional<double> value;  // in the unit of the column; none: does not apply
  double u = 0;                 // standard uncertainty; 0: not known
};

struct ComparisonRow {
  std::string method;
  std::vector<ComparisonCell> cells;  // one a column; none: the method was left out, as the note says
  std::string note;                   // minimum on the edge, no convergence
};

struct Comparison {
  std::vector<ComparisonColumn> columns;
  std::vector<ComparisonRow> rows;
};

}  // namespace scancal
