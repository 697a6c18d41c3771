#include <algorithm>
#include <cctype>
#include <utility>
#include "io/csv_fields.h"
#include "io/scan_columns.h"
#include "io/scan_source.h"
#include "io/text_lines.h"

namespace scancal {
namespace {

// The column as the model wants it; if it did not say, what the data set's format fixes: bearings are angles, y, z and
// range are lengths.
ScanColumn ColumnOf(const ScanFormat& format, const std::string& name) {
  for (const ScanColumn& column : format.columns) {
    if (column.name == name) return column;
  }
  const bool angle = name == "angle" || name == "bearing";
  return {.name = name, .dimension = angle ? Dimension::kAngle : Dimension::kLength};
}

// One profile per line.
class WideReader : public ScanSource {
 public:
  WideReader(const ScanFormat& format, TextLines text)
      : format_(format),
        layout_(*format.layout),
        text_(std::move(text)),
        wanted_lines_(format),
        invalid_(InvalidValue(format)),
        angle_factor_(format.units.Of(ColumnOf(format, "angle").dimension)),
        across_factor_(format.units.Of(ColumnOf(format, layout_.across).dimension)),
        value_factor_(format.units.Of(ColumnOf(format, layout_.value).dimension)) {}

  Result<void> CheckLayout() const;
  Result<bool> Next(ScanBatch* batch) override;
  int64_t bytes_read() const override { return text_.bytes_read(); }
  int64_t bytes_total() const override { return text_.bytes_total(); }

 private:
  Result<void> ReadLine(std::string_view line, ScanBatch* batch);
  bool TakesHeader(std::string_view line);
  Result<void> ReadCells(std::string_view line, ParsedNumber* angle);
  Result<void> CheckCellCount(std::string_view line);
  std::string Place() const { return text_.name() + ":" + std::to_string(line_); }

  ScanFormat format_;
  WideLayout layout_;
  TextLines text_;
  LineRange wanted_lines_;
  double invalid_, angle_factor_, across_factor_, value_factor_;
  ColumnParser angle_parser_, value_parser_;
  std::vector<double> values_;  // of the line, as they stand in the file; nan if missing
  size_t cells_ = 0;            // of every line
  bool first_ = true;           // the line in hand is the first with cells
  int64_t line_ = 0;            // its number
  int64_t lines_with_cells_ = 0;
};

Result<void> WideReader::CheckLayout() const {
  if (layout_.angle_column >= 1 && layout_.angle_column < layout_.first_column) return {};
  return Error{text_.name() + ": layout: found angle_column: " + std::to_string(layout_.angle_column) +
               ", first_column: " + std::to_string(layout_.first_column) +
               ", expected the column of the angle, counted from 1, before the first cell"};
}

Result<bool> WideReader::Next(ScanBatch* batch) {
  batch->names = {"angle", layout_.across, layout_.value, "profile"};
  batch->columns.resize(batch->names.size());
  for (std::vector<double>& column : batch->columns) column.clear();
  while (batch->size() < kBatchPoints && line_ < wanted_lines_.last) {
    SCANCAL_ASSIGN_OR_RETURN(const auto line, text_.TakeLine());
    if (!line) break;
    ++line_;
    if (IsWithoutCells(*line)) continue;
    if (std::exchange(first_, false) && TakesHeader(*line)) continue;
    if (line_ < wanted_lines_.first) continue;
    ++lines_with_cells_;
    SCANCAL_RETURN_IF_ERROR(ReadLine(*line, batch));
  }
  if (lines_with_cells_ == 0) return NoPoints(format_, line_);
  return batch->size() > 0;
}

// A header is told by the angle's cell: a name, no number. Units in names ("angle_rad", "y_um") win.
bool WideReader::TakesHeader(std::string_view line) {
  const std::vector<CsvField> cells = SplitCells(line);
  const auto angle = static_cast<size_t>(layout_.angle_column - 1),
             first = static_cast<size_t>(layout_.first_column - 1);
  if (angle >= cells.size() || ParseNumber(cells[angle].text).kind != NumberKind::kText) return false;
  const auto initial = static_cast<unsigned char>(cells[angle].text.front());
  if (initial < 0x80 && std::isalpha(initial) == 0) return false;  // a broken number like 12.3.4 is no name
  angle_factor_ = MatchColumn(ColumnOf(format_, "angle"), cells[angle].text, format_.units).value_or(angle_factor_);
  if (first < cells.size()) {
    const ScanColumn value = ColumnOf(format_, layout_.value);
    value_factor_ = MatchColumn(value, cells[first].text, format_.units).value_or(value_factor_);
  }
  return true;
}

Result<void> WideReader::ReadLine(std::string_view line, ScanBatch* batch) {
  ParsedNumber angle;
  SCANCAL_RETURN_IF_ERROR(ReadCells(line, &angle));
  SCANCAL_RETURN_IF_ERROR(CheckCellCount(line));
  const bool angle_missing = angle.kind == NumberKind::kMissing || angle.value == invalid_;
  for (size_t i = 0; i < values_.size(); ++i) {
    if (angle_missing || std::isnan(values_[i])) {
      ++missing_;
      continue;
    }
    batch->columns[0].push_back(angle.value * angle_factor_);
    batch->columns[1].push_back((layout_.start + layout_.step * static_cast<double>(i)) * across_factor_);
    batch->columns[2].push_back(values_[i] * value_factor_);
    batch->columns[3].push_back(static_cast<double>(line_));
  }
  return {};
}

// The angle and values_ of a line, which is followed by '\n'.
Result<void> WideReader::ReadCells(std::string_view line, ParsedNumber* angle) {
  const char* const line_end = line.data() + line.size();
  const char* at = line.data();
  values_.clear();
  for (int column = 1;; ++column, ++at) {
    const char* const cell = at;
    ParsedNumber number;
    if (column == layout_.angle_column) {
      at = ReadCell(cell, line_end, angle_parser_, angle);
      if (angle->kind > NumberKind::kMissing) return WrongCsvCell(Place(), line, cell, "angle", angle->kind);
    } else if (column >= layout_.first_column) {
      at = ReadCell(cell, line_end, value_parser_, &number);
      if (number.kind > NumberKind::kMissing) return WrongCsvCell(Place(), line, cell, layout_.value, number.kind);
      const bool missing = number.kind == NumberKind::kMissing || number.value == invalid_;
      values_.push_back(missing ? std::numeric_limits<double>::quiet_NaN() : number.value);
    } else {
      at = SkipCell(cell);
    }
    if (*at == '\n') return {};
  }
}

Result<void> WideReader::CheckCellCount(std::string_view line) {
  if (cells_ == 0) cells_ = values_.size();
  if (cells_ == values_.size() && cells_ > 0) return {};
  const std::string found = Place() + ": found " + std::to_string(values_.size()) + " cells from column " +
                            std::to_string(layout_.first_column) + " on, expected ";
  if (cells_ == 0) return Error{found + "at least one" + WrongSeparator(line)};
  SCANCAL_ASSIGN_OR_RETURN(const bool more, text_.Fill());
  const bool cut = values_.size() < cells_ && !more;
  return Error{found + std::to_string(cells_) + " as before" + (cut ? "; the file is probably cut off here" : "")};
}

}  // namespace

Result<std::unique_ptr<ScanSource>> OpenWideCsv(const ScanFormat& format) {
  SCANCAL_ASSIGN_OR_RETURN(TextLines text, TextLines::Open(format.path));
  auto reader = std::make_unique<WideReader>(format, std::move(text));
  SCANCAL_RETURN_IF_ERROR(reader->CheckLayout());
  return std::unique_ptr<ScanSource>(std::move(reader));
}

}  // namespace scancal
