#include "io/table.h"
#include <algorithm>
#include <stdexcept>
#include <utility>
#include "io/delimited.h"
#include "io/message.h"
#include "io/scan.h"

namespace scancal {

Result<Table> Table::Read(const std::filesystem::path& path, const std::vector<TableColumn>& columns,
                          const Units& units, std::vector<std::string> header) {
  ScanFormat format;
  format.path = path;
  format.units = units;
  format.npy_columns = std::move(header);
  return Read(std::move(format), columns);
}

Result<Table> Table::Read(ScanFormat format, const std::vector<TableColumn>& columns) {
  SCANCAL_ASSIGN_OR_RETURN(DelimitedText text, DelimitedText::Open(format.path));
  Table table;
  table.name_ = text.name();
  format.columns.clear();
  for (const TableColumn& column : columns) {
    const bool required = column.required || format.names.contains(column.name);
    format.columns.push_back({column.name, column.dimension, required, column.remedy});
  }
  std::vector<std::string> header = format.npy_columns;
  const bool nameless = !header.empty();
  const auto match = [&](const std::vector<std::string>& names) {
    std::vector<size_t> numbers;
    const auto found = ChooseColumns(format, names, "");
    for (size_t k = 0; found.ok() && k < found->size(); ++k)
      for (const TableColumn& column : columns)
        if (column.name == (*found)[k].name && column.cells >= Cells::kNumber) numbers.push_back((*found)[k].index);
    if (found.ok() && numbers.empty()) numbers.push_back(found->front().index);
    return numbers;
  };
  std::optional<NumberRows> rows;
  if (nameless) rows = {header.size(), true, match(header)};
  SCANCAL_ASSIGN_OR_RETURN(const TextHead head, text.TakeHead(format.text, nameless ? ColumnMatcher() : match, rows));
  if (!nameless) {
    if (head.names.empty()) return Error{table.name_ + ": the file is empty, expected a header line and lines of data"};
    header = head.names;
  }
  table.dialect_ = text.Describe();
  auto chosen = ChooseColumns(format, header, nameless ? table.name_ : text.Place(), head.units);
  if (!chosen.ok()) return Error{chosen.error().message + (nameless ? "" : text.WrongSeparator()), chosen.error().kind};
  SCANCAL_ASSIGN_OR_RETURN(auto where, ChooseWhere(format, header, nameless ? table.name_ : text.Place()));
  text.KeepWhere(std::move(where));
  std::sort(chosen->begin(), chosen->end(), [](const auto& a, const auto& b) { return a.index < b.index; });
  std::vector<ExpectedCells> cells(header.size(), {Cells::kTextOrNothing});
  for (const ChosenColumn& column : *chosen) {
    const auto is_it = [&](const TableColumn& wanted) { return wanted.name == column.name; };
    const std::string& called = header[column.index];
    if (cells[column.index].cells != Cells::kTextOrNothing)
      return Error{table.name_ + ": the column '" + called + "' is declared to be both " +
                   Listed({table.columns_.back().name, column.name}) + ", expected a column of its own for each"};
    cells[column.index] = {std::find_if(columns.begin(), columns.end(), is_it)->cells, called};
    table.columns_.push_back({column.name, called, {}, {}, {}});
  }
  text.Expect(cells, std::move(header), CellCount::kFirst);
  for (;;) {
    SCANCAL_ASSIGN_OR_RETURN(const bool more, text.Next());
    if (!more) break;
    for (size_t k = 0; k < chosen->size(); ++k) {
      const size_t index = (*chosen)[k].index;
      Column& column = table.columns_[k];
      if (cells[index].cells <= Cells::kText) column.texts.push_back(text.Text(index));
      else column.numbers.push_back(text.Number(index) * (*chosen)[k].factor);
      column.starts.push_back(static_cast<uint32_t>(text.Start(index)));
    }
    table.lines_.push_back(static_cast<uint32_t>(text.line()));
  }
  if (table.rows() > 0) return table;
  return Error{table.name_ + ": found no line" + (nameless ? "" : " below the header") +
               (format.text.where.empty() ? "" : " with what `where` asks for") + ", expected lines of data"};
}

std::string Table::Place(size_t row) const { return name_ + ":" + std::to_string(lines_[row]); }

Error Table::Wrong(size_t row, std::string_view column, const std::string& sentence) const {
  const Column& found = At(column);
  return {Place(row) + ":" + std::to_string(found.starts[row]) + ": " + found.called + ": " + sentence};
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
