#include "io/table.h"
#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>
#include "io/delimited.h"
#include "io/message.h"
#include "io/scan.h"

namespace scancal {

class TableReader {
 public:
  TableReader(const std::vector<TableColumn>& columns, const Units& units, const std::vector<std::string>& header,
              TextLines text)
      : wanted_(columns), units_(units), text_(std::move(text)), header_(header), nameless_(!header.empty()) {
    table_.name_ = text_.name();
  }

  Result<Table> Run() {
    SCANCAL_RETURN_IF_ERROR(ReadHeader());
    for (;;) {
      SCANCAL_ASSIGN_OR_RETURN(const bool more, NextLine());
      if (!more) break;
      SCANCAL_RETURN_IF_ERROR(ReadRow());
    }
    if (table_.rows() == 0)
      return Error{table_.name_ + ": found no line" + (nameless_ ? "" : " below the header") +
                   ", expected lines of data"};
    return std::move(table_);
  }

 private:
  struct FileColumn {
    int target = -1;  // column of the table; -1: ignored
    double factor = 1;
    Cells cells = Cells::kText;
    ColumnParser parser;
  };

  std::string Place() const { return table_.name_ + ":" + std::to_string(line_number_); }

  // line_ := the next line with cells.
  Result<bool> NextLine() {
    do {
      SCANCAL_ASSIGN_OR_RETURN(const auto line, text_.TakeLine());
      if (!line) return false;
      ++line_number_;
      line_ = *line;
    } while (IsWithoutCells(line_));
    return true;
  }

  Result<void> ReadHeader() {
    if (!nameless_) {
      SCANCAL_ASSIGN_OR_RETURN(const bool found, NextLine());
      if (!found) return Error{table_.name_ + ": the file is empty, expected a header line and lines of data"};
      for (CsvField& field : SplitCells(line_)) header_.push_back(std::move(field.text));
    }
    ScanFormat format;
    format.units = units_;
    for (const TableColumn& column : wanted_)
      format.columns.push_back({column.name, column.dimension, column.required, column.remedy});
    const auto chosen = ChooseColumns(format, header_, nameless_ ? table_.name_ : Place());
    if (!chosen.ok()) return Error{chosen.error().message + WrongSeparator(line_)};
    columns_.resize(header_.size());
    for (const ChosenColumn& column : *chosen) {
      const auto wanted =
          std::find_if(wanted_.begin(), wanted_.end(), [&](const TableColumn& w) { return w.name == column.name; });
      columns_[column.index] = {static_cast<int>(table_.columns_.size()), column.factor, wanted->cells, {}};
      table_.columns_.push_back({column.name, {}, {}, {}});
    }
    return {};
  }

  Result<void> ReadRow() {
    const char* at = line_.data() - 1;
    const char* const end = line_.data() + line_.size();  // '\n' stands there
    const char* counted = line_.data();
    uint32_t start = 1;
    for (FileColumn& column : columns_) {
      if (at == end) return WrongCellCount();
      const char* cell = ++at;  // behind the comma
      while (*cell == ' ') ++cell;
      if (column.target < 0) {
        at = SkipCell(cell);
        continue;
      }
      Table::Column& target = table_.columns_[static_cast<size_t>(column.target)];
      start += static_cast<uint32_t>(CountCharacters(std::string_view(counted, static_cast<size_t>(cell - counted))));
      counted = cell;
      target.starts.push_back(start);
      if (column.cells == Cells::kText) {
        SCANCAL_RETURN_IF_ERROR(TakeText(cell, &at, &target));
      } else {
        SCANCAL_RETURN_IF_ERROR(TakeNumber(cell, &at, &column, &target));
      }
    }
    if (at != end) return WrongCellCount();
    table_.lines_.push_back(line_number_);
    return {};
  }

  Result<void> TakeText(const char* cell, const char** at, Table::Column* target) {
    *at = SkipCell(cell);
    std::string text = CellText({cell, *at});
    if (text.empty())
      return Error{Place() + ":" + std::to_string(target->starts.back()) + ": " + target->name +
                   ": the cell is empty, expected text"};
    target->texts.push_back(std::move(text));
    return {};
  }

  Result<void> TakeNumber(const char* cell, const char** at, FileColumn* column, Table::Column* target) {
    ParsedNumber number;
    *at = ReadCell(cell, line_.data() + line_.size() + 1, column->parser, &number);
    if (number.kind == NumberKind::kMissing && column->cells == Cells::kNumberOrNothing)
      number = {NumberKind::kNumber, std::numeric_limits<double>::quiet_NaN()};
    if (number.kind != NumberKind::kNumber) {
      // A line that is cut off has the wrong number of cells in the first place.
      if (SplitCells(line_).size() != columns_.size()) return WrongCellCount();
      return WrongCsvCell(Place(), line_, cell, target->name, number.kind);
    }
    target->numbers.push_back(number.value * column->factor);
    return {};
  }

  Error WrongCellCount() const {
    const size_t found = SplitCells(line_).size();
    return {Place() + ": found " + std::to_string(found) + (found == 1 ? " cell" : " cells") + ", expected " +
            std::to_string(columns_.size()) + " (" + Listed(header_) + ")" + WrongSeparator(line_)};
  }

  const std::vector<TableColumn>& wanted_;
  const Units& units_;
  TextLines text_;
  std::string_view line_;
  uint32_t line_number_ = 0;
  std::vector<std::string> header_;
  bool nameless_;                    // the file has no header
  std::vector<FileColumn> columns_;  // of the file
  Table table_;
};

Result<Table> Table::Read(const std::filesystem::path& path, const std::vector<TableColumn>& columns,
                          const Units& units, const std::vector<std::string>& header) {
  SCANCAL_ASSIGN_OR_RETURN(TextLines text, TextLines::Open(path));
  return TableReader(columns, units, header, std::move(text)).Run();
}

std::string Table::Place(size_t row) const { return name_ + ":" + std::to_string(lines_[row]); }

Error Table::Wrong(size_t row, std::string_view column, const std::string& sentence) const {
  const Column& found = At(column);
  return {Place(row) + ":" + std::to_string(found.starts[row]) + ": " + found.name + ": " + sentence};
}

const Table::Column* Table::Find(std::string_view column) const {
  for (const Column& candidate : columns_)
    if (candidate.name == column) return &candidate;
  return nullptr;
}

const Table::Column& Table::At(std::string_view column) const {
  if (const Column* const found = Find(column)) return *found;
  throw std::logic_error("no column " + std::string(column));  // our own mistake; io/ has no CHECK
}

}  // namespace scancal
