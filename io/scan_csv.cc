#include <algorithm>
#include <cctype>
#include <utility>
#include "io/delimited.h"
#include "io/message.h"
#include "io/scan.h"

namespace scancal {
namespace {

constexpr size_t kIgnored = static_cast<size_t>(-1);

struct CsvColumn {           // of the file
  size_t target = kIgnored;  // column of the batch
  double factor = 1;
  ColumnParser parser;
};

// One point per line, a header with names.
class CsvReader : public ScanReader {
 public:
  CsvReader(const ScanFormat& format, TextLines text)
      : format_(format), text_(std::move(text)), wanted_lines_(format), invalid_(InvalidValue(format)) {}

  Result<void> ReadHeader();
  Result<bool> Next(ScanBatch* batch) override;
  int64_t bytes_read() const override { return text_.bytes_read(); }
  int64_t bytes_total() const override { return text_.bytes_total(); }

 private:
  enum class Line { kPoint, kMissing, kWrong };
  Line ReadLine(size_t row);
  Line Wrong(const char* cell, const CsvColumn& column, NumberKind kind);
  Result<void> ReadBlock(size_t* points);
  bool SkipsLine();
  std::string_view FirstLine() const;
  std::string Place() const { return text_.name() + ":" + std::to_string(line_); }
  Error Complaint();
  Error WrongCellCount(size_t found);

  ScanFormat format_;
  TextLines text_;
  LineRange wanted_lines_;
  double invalid_;
  std::vector<std::string> header_;
  std::vector<CsvColumn> columns_;  // of the file
  std::vector<std::string> names_;  // of the batch
  std::vector<double*> targets_;    // the columns of the batch
  int64_t line_ = 1;                // the number of the line at text_.begin()
  int64_t lines_with_cells_ = 0;
  const char* wrong_cell_ = nullptr;  // where ReadLine stumbled; nullptr: over the number of cells
  NumberKind wrong_kind_ = NumberKind::kText;
  std::string wrong_name_;
};

std::vector<std::string> TextsOf(const std::vector<CsvField>& fields) {
  std::vector<std::string> texts;
  texts.reserve(fields.size());
  for (const CsvField& field : fields) texts.push_back(field.text);
  return texts;
}

// A first line of numbers, in one cell if the commas are missing.
bool IsWithoutNames(const std::vector<std::string>& header) {
  const std::string first = header.front().substr(0, header.front().find_first_of(";\t "));
  if (header.size() == 1) return ParseNumber(first).kind == NumberKind::kNumber;
  bool any_number = false;
  for (const std::string& text : header) {
    const NumberKind kind = ParseNumber(text).kind;
    if (kind == NumberKind::kText) return false;
    any_number |= kind == NumberKind::kNumber;
  }
  return any_number;
}

Result<void> CsvReader::ReadHeader() {
  std::optional<std::string_view> line;
  do {
    SCANCAL_ASSIGN_OR_RETURN(line, text_.TakeLine());
    if (!line) return NoPoints(format_, line_ - 1);
    ++line_;
  } while (IsWithoutCells(*line));
  const std::string place = text_.name() + ":" + std::to_string(line_ - 1);
  header_ = TextsOf(SplitCells(*line));
  const std::string wrong_separator = WrongSeparator(*line);
  if (IsWithoutNames(header_)) {
    return Error{place + ": found numbers, expected a header line with the names of the columns" + wrong_separator};
  }
  auto chosen = ChooseColumns(format_, header_, place);
  if (!chosen.ok()) return Error{chosen.error().message + wrong_separator, chosen.error().kind};
  columns_.resize(header_.size());
  for (const ChosenColumn& column : *chosen) {
    columns_[column.index].target = names_.size();
    columns_[column.index].factor = column.factor;
    names_.push_back(column.name);
  }
  return {};
}

Result<bool> CsvReader::Next(ScanBatch* batch) {
  batch->names = names_;
  batch->columns.resize(names_.size());
  targets_.clear();
  for (std::vector<double>& column : batch->columns) {
    column.resize(kBatchPoints);
    targets_.push_back(column.data());
  }
  size_t points = 0;
  while (points < kBatchPoints && line_ <= wanted_lines_.last) {
    SCANCAL_ASSIGN_OR_RETURN(const bool filled, text_.Fill());
    if (!filled) break;
    SCANCAL_RETURN_IF_ERROR(ReadBlock(&points));
  }
  for (std::vector<double>& column : batch->columns) column.resize(points);
  if (lines_with_cells_ == 0) return NoPoints(format_, line_ - 1);
  return points > 0;
}

Result<void> CsvReader::ReadBlock(size_t* points) {
  size_t row = *points;
  for (; row < kBatchPoints && text_.begin() != text_.end() && line_ <= wanted_lines_.last; ++line_) {
    if (SkipsLine()) continue;
    ++lines_with_cells_;
    const Line line = ReadLine(row);
    if (line == Line::kWrong) return Complaint();
    if (line == Line::kPoint) ++row;
    else ++missing_;
  }
  *points = row;
  return {};
}

// The line at text_.begin().
std::string_view CsvReader::FirstLine() const {
  const std::string_view block(text_.begin(), static_cast<size_t>(text_.end() - text_.begin()));
  return block.substr(0, block.find('\n'));
}

// Walks over a line that is unwanted or has no cells.
bool CsvReader::SkipsLine() {
  const char first = *text_.begin();
  const bool wanted = line_ >= wanted_lines_.first;
  if (wanted && first > ' ' && first != '#') return false;  // at a glance: nearly every line
  const std::string_view line = FirstLine();
  if (wanted && !IsWithoutCells(line)) return false;
  text_.SkipTo(line.data() + line.size() + 1);
  return true;
}

// The line at text_.begin() into a row of the targets; stays at a line that is wrong.
CsvReader::Line CsvReader::ReadLine(size_t row) {
  const char* at = text_.begin() - 1;
  bool missing = false;
  for (CsvColumn& column : columns_) {
    const char* const cell = ++at;  // behind the comma
    if (column.target == kIgnored) {
      at = SkipCell(cell);
    } else {
      ParsedNumber number;
      at = ReadCell(cell, text_.end(), column.parser, &number);
      if (number.kind > NumberKind::kMissing) return Wrong(cell, column, number.kind);
      missing |= number.kind == NumberKind::kMissing || number.value == invalid_;
      targets_[column.target][row] = number.value * column.factor;
    }
    if (*at != ',' && &column != &columns_.back()) return Line::kWrong;
  }
  if (*at != '\n') return Line::kWrong;
  text_.SkipTo(at + 1);
  return missing ? Line::kMissing : Line::kPoint;
}

CsvReader::Line CsvReader::Wrong(const char* cell, const CsvColumn& column, NumberKind kind) {
  wrong_cell_ = cell;
  wrong_kind_ = kind;
  wrong_name_ = names_[column.target];
  return Line::kWrong;
}

// What ReadLine stumbled over.
Error CsvReader::Complaint() {
  const std::string_view line = FirstLine();
  if (wrong_cell_ == nullptr) return WrongCellCount(SplitCells(line).size());
  return WrongCsvCell(Place(), line, wrong_cell_, wrong_name_, wrong_kind_);
}

Error CsvReader::WrongCellCount(size_t found) {
  std::string message = Place() + ": found " + std::to_string(found) + (found == 1 ? " cell" : " cells") +
                        ", expected " + std::to_string(columns_.size()) + " (" + Listed(header_) + ")";
  const std::string_view line = FirstLine();
  text_.SkipTo(line.data() + line.size() + 1);
  const auto more = text_.Fill();
  if (found < columns_.size() && more.ok() && !*more) message += "; the file is probably cut off here";
  return Error{std::move(message)};
}

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
class WideReader : public ScanReader {
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

Result<std::unique_ptr<ScanReader>> OpenCsv(const ScanFormat& format) {
  SCANCAL_ASSIGN_OR_RETURN(TextLines text, TextLines::Open(format.path));
  auto reader = std::make_unique<CsvReader>(format, std::move(text));
  SCANCAL_RETURN_IF_ERROR(reader->ReadHeader());
  return std::unique_ptr<ScanReader>(std::move(reader));
}

Result<std::unique_ptr<ScanReader>> OpenWideCsv(const ScanFormat& format) {
  SCANCAL_ASSIGN_OR_RETURN(TextLines text, TextLines::Open(format.path));
  auto reader = std::make_unique<WideReader>(format, std::move(text));
  SCANCAL_RETURN_IF_ERROR(reader->CheckLayout());
  return std::unique_ptr<ScanReader>(std::move(reader));
}

}  // namespace scancal
