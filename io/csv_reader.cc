#include <utility>
#include "io/csv_fields.h"
#include "io/message.h"
#include "io/scan_columns.h"
#include "io/scan_source.h"
#include "io/text_lines.h"

namespace scancal {
namespace {

constexpr size_t kIgnored = static_cast<size_t>(-1);

struct CsvColumn {           // of the file
  size_t target = kIgnored;  // column of the batch
  double factor = 1;
  ColumnParser parser;
};

// One point per line, a header with names.
class CsvReader : public ScanSource {
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
  if (!chosen.ok()) return Error{chosen.error().message + wrong_separator};
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

}  // namespace

Result<std::unique_ptr<ScanSource>> OpenCsv(const ScanFormat& format) {
  SCANCAL_ASSIGN_OR_RETURN(TextLines text, TextLines::Open(format.path));
  auto reader = std::make_unique<CsvReader>(format, std::move(text));
  SCANCAL_RETURN_IF_ERROR(reader->ReadHeader());
  return std::unique_ptr<ScanSource>(std::move(reader));
}

}  // namespace scancal
