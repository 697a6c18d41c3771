// Small tables with columns of text and of numbers.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>
#include "io/delimited.h"
#include "io/result.h"
#include "io/scan.h"
#include "io/units.h"

namespace scancal {

struct TableColumn {
  std::string name;  // "pose", "x"
  Cells cells = Cells::kText;
  Dimension dimension = Dimension::kNone;
  bool required = true;
  std::string remedy = {};  // behind the complaint that a required one is missing: "; ..."
};

// A CSV file with a header, as a whole: quotes, blanks, a byte order mark, CRLF, lines that are empty or begin with #
// are no part of the cells; a unit in a column's name (x_m, q1_rad) wins over the declared one; unknown columns are
// ignored. Text is never empty, numbers are finite, in mm and rad. A few 10^5 lines read in a fraction of a second; for
// points by the million there is ScanReader.
class Table {
 public:
  // format: of its text, as a data set declares it; its own columns are these.
  static Result<Table> Read(ScanFormat format, const std::vector<TableColumn>& columns);
  // The same of a file that needs no declaration. header: names of the columns of a file that has no header.
  static Result<Table> Read(const std::filesystem::path& path, const std::vector<TableColumn>& columns,
                            const Units& units, std::vector<std::string> header = {});
  size_t rows() const { return lines_.size(); }  // one or more
  bool Has(std::string_view column) const { return Find(column) != nullptr; }
  const std::string& Text(std::string_view column, size_t row) const { return At(column).texts[row]; }
  double Number(std::string_view column, size_t row) const { return At(column).numbers[row]; }
  const std::vector<std::string>& Texts(std::string_view column) const { return At(column).texts; }
  const std::vector<double>& Numbers(std::string_view column) const { return At(column).numbers; }
  const std::string& name() const { return name_; }                                       // of the file, for messages
  const std::string& dialect() const { return dialect_; }                                 // DelimitedText::Describe
  std::string Place(size_t row) const;                                                    // balls.csv:12
  const std::string& Called(std::string_view column) const { return At(column).called; }  // by the file
  // balls.csv:12:5: Ball: and the sentence; the column as the file calls it
  Error Wrong(size_t row, std::string_view column, const std::string& sentence) const;

 private:
  struct Column {
    std::string name, called;  // as wanted, as the file says
    std::vector<std::string> texts;
    std::vector<double> numbers;
    std::vector<uint32_t> starts;  // of the cells in their lines, in characters, 1-based
  };
  const Column* Find(std::string_view column) const;  // nullptr: not in the file
  const Column& At(std::string_view column) const;    // CHECKs

  std::string name_, dialect_;
  std::vector<Column> columns_;
  std::vector<uint32_t> lines_;  // of the rows, 1-based
};

}  // namespace scancal
