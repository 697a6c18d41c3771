// Scans in delimited text: a point or a profile per line.
#include "io/scan_csv.h"
#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

namespace scancal {
namespace {

// A first row of numbers, in one cell if the commas are missing.
bool IsWithoutNames(const std::vector<std::string>& header) {
  const std::string first = header.front().substr(0, header.front().find_first_of(";\t "));
  if (header.size() == 1) return ParseNumber(first).kind == NumberKind::kNumber;
  bool any_number = false;
  for (std::string text : header) {
    std::replace(text.begin(), text.end(), ',', '.');
    const NumberKind kind = ParseNumber(text).kind;
    if (kind == NumberKind::kText) return false;
    any_number |= kind == NumberKind::kNumber;
  }
  return any_number;
}

// A point per line, a header with names.
class LongReader : public CsvReader {
 public:
  using CsvReader::CsvReader;

  Result<void> ReadHeader() {
    const auto match = [&](const std::vector<std::string>& names) {
      std::vector<size_t> indices;
      const auto columns = ChooseColumns(format_, names, "");
      if (columns.ok())
        for (const ChosenColumn& column : *columns) indices.push_back(column.index);
      return indices;
    };
    std::optional<NumberRows> nameless;
    if (!format_.npy_columns.empty()) nameless = {format_.npy_columns.size(), true, match(format_.npy_columns)};
    SCANCAL_ASSIGN_OR_RETURN(const TextHead head, text_.TakeHead(format_.text, match, nameless));
    if (head.names.empty() && !head.is_known) {
      SCANCAL_RETURN_IF_ERROR(text_.Peek());
      return NoPoints(format_, text_.line());
    }
    std::vector<std::string> header = head.is_known && head.is_nameless ? format_.npy_columns : head.names;
    if (!head.is_known && IsWithoutNames(header))
      return Error{text_.Place() + ": found numbers, expected a header line with the names of the columns; or " +
                       "columns: [angle, y, z] in the data set, in the order of the file" + text_.WrongSeparator(),
                   ErrorKind::kUnknownLayout};
    auto chosen = ChooseColumns(format_, header, text_.Place(), head.units);
    if (!chosen.ok()) return Error{chosen.error().message + text_.WrongSeparator(), chosen.error().kind};
    columns_ = *std::move(chosen);
    SCANCAL_RETURN_IF_ERROR(KeepWhere(header));
    text_.TreatAsMissing(format_.text.missing);
    std::vector<ExpectedCells> cells(header.size());
    for (const ChosenColumn& column : columns_) cells[column.index] = {Cells::kNumberOrNothing, column.name};
    text_.Expect(std::move(cells), std::move(header), CellCount::kLast);
    KeepLines();
    return {};
  }

  Result<bool> Next(ScanBatch* batch) override {
    batch->names.clear();
    for (const ChosenColumn& column : columns_) batch->names.push_back(column.name);
    batch->columns.resize(columns_.size());
    std::vector<double*> targets;
    for (std::vector<double>& column : batch->columns) {
      column.resize(kBatchPoints);
      targets.push_back(column.data());
    }
    size_t points = 0;
    while (points < kBatchPoints) {
      SCANCAL_ASSIGN_OR_RETURN(const bool more, text_.Next());
      if (!more) break;
      bool missing = false;
      for (size_t k = 0; k < columns_.size(); ++k) {
        const double number = text_.Number(columns_[k].index);
        missing |= IsMissing(number);
        targets[k][points] = number * columns_[k].factor;
      }
      if (missing) ++missing_;
      else ++points;
    }
    for (std::vector<double>& column : batch->columns) column.resize(points);
    return Taken(points);
  }

 private:
  std::vector<ChosenColumn> columns_;
};

// A profile per line, or per column.
class WideReader : public CsvReader {
 public:
  WideReader(const ScanFormat& format, DelimitedText text)
      : CsvReader(format, std::move(text)),
        layout_(*format.layout),
        has_angle_(layout_.angle_column > 0 && !layout_.tall),
        angle_(static_cast<size_t>(std::max(layout_.angle_column, 1) - 1)),
        first_(static_cast<size_t>(layout_.first_column - 1)),
        angle_factor_(format.units.Of(ColumnOf("angle").dimension)),
        across_factor_(format.units.Of(ColumnOf(layout_.across).dimension)),
        value_factor_(format.units.Of(ColumnOf(layout_.value).dimension)) {}

  std::optional<double> FirstProfile() const override { return first_profile_; }
  bool gives_heights() const override { return layout_.heights; }
  std::string Describe() const override {
    const std::string text = CsvReader::Describe();
    return text + (text.empty() || layout_.echo.empty() ? "" : ", ") + layout_.echo;
  }

  Result<void> ReadHeader() {
    if (layout_.HasNoAngles()) {
      SCANCAL_ASSIGN_OR_RETURN(by_profile_, AnglesByProfile(format_));
    }
    if (layout_.angle_column < 0 || layout_.angle_column >= layout_.first_column)
      return Error{text_.name() + ": layout: found angle_column: " + std::to_string(layout_.angle_column) +
                   ", first_column: " + std::to_string(layout_.first_column) +
                   ", expected the column of the angle, counted from 1, before the first cell"};
    const NumberRows rows{first_ + 1, false, {has_angle_ || layout_.tall ? angle_ : first_}};
    SCANCAL_ASSIGN_OR_RETURN(const TextHead head, text_.TakeHead(format_.text, nullptr, rows));
    SCANCAL_ASSIGN_OR_RETURN(std::string_view row, text_.Peek());
    const std::vector<std::string> header = head.is_known ? head.names : SplitCells(row);
    SCANCAL_RETURN_IF_ERROR(KeepWhere(header));
    if (IsHeader(header)) {  // units in names ("angle_rad", "y_um") win
      const Units& units = format_.units;
      if (layout_.tall)
        across_factor_ = MatchColumn(ColumnOf(layout_.across), header[angle_], units).value_or(across_factor_);
      angle_factor_ = MatchColumn(ColumnOf("angle"), header[angle_], units).value_or(angle_factor_);
      if (first_ < header.size())
        value_factor_ = MatchColumn(ColumnOf(layout_.value), header[first_], units).value_or(value_factor_);
      if (!head.is_known) text_.Skip();
    }
    text_.TreatAsMissing(format_.text.missing);
    KeepLines();
    SCANCAL_ASSIGN_OR_RETURN(row, text_.Peek());
    trailing_ = layout_.tall && WithoutBlanks(row).ends_with(',') ? 1 : 0;
    // Up to the first cell, or as many as this row can have: if that is fewer it is refused.
    std::vector<ExpectedCells> cells(std::min(first_, row.size()) + 1);
    cells.back() = {Cells::kNumberOrNothing, layout_.value};
    if ((has_angle_ || layout_.tall) && angle_ < cells.size())
      cells[angle_] = {Cells::kNumberOrNothing, layout_.tall ? layout_.across : "angle"};
    text_.Expect(std::move(cells), {}, CellCount::kAny);
    return {};
  }

  Result<bool> Next(ScanBatch* batch) override {
    batch->names = {"angle", layout_.across, layout_.value, "profile"};
    batch->columns.resize(batch->names.size());
    for (std::vector<double>& column : batch->columns) column.clear();
    size_t points = 0;
    while (points < kBatchPoints) {
      SCANCAL_ASSIGN_OR_RETURN(const bool more, text_.Next());
      if (!more) break;
      SCANCAL_RETURN_IF_ERROR(CheckCellCount());
      const size_t end = cells_ - trailing_, most = points + end - first_;
      double* targets[4];
      for (size_t i = 0; i < 4; ++i) {
        batch->columns[i].resize(most);
        targets[i] = batch->columns[i].data();
      }
      const double angle = has_angle_ ? text_.Number(angle_) : 0, profile = static_cast<double>(text_.line());
      const double across = layout_.tall ? text_.Number(angle_) : 0;
      const bool no_angle = IsMissing(angle) || IsMissing(across);
      if (!first_profile_) first_profile_ = layout_.tall ? 1 : profile;
      for (size_t k = first_; k < end; ++k) {
        const double value = text_.Number(k);
        const auto number = static_cast<double>(k - first_);
        targets[1][points] = (layout_.tall ? across : layout_.start + layout_.step * number) * across_factor_;
        targets[2][points] = (layout_.scale * value + layout_.offset) * value_factor_;
        targets[3][points] = layout_.tall ? 1 + number : profile;
        targets[0][points] = by_profile_ ? targets[3][points] : angle * angle_factor_;
        if (!no_angle && !IsMissing(value)) ++points;
      }
      missing_ += static_cast<int64_t>(most - points);
    }
    for (std::vector<double>& column : batch->columns) column.resize(points);
    return Taken(points);
  }

 private:
  // The column as the model wants it; if it did not say, what the data set's format fixes: bearings are angles, y, z
  // and range are lengths.
  ScanColumn ColumnOf(const std::string& name) const {
    for (const ScanColumn& column : format_.columns) {
      if (column.name == name) return column;
    }
    const bool angle = name == "angle" || name == "bearing";
    return {.name = name, .dimension = angle ? Dimension::kAngle : Dimension::kLength};
  }

  Result<void> CheckCellCount() {
    const size_t cells = std::max(text_.cells(), first_);
    if (cells_ == 0) cells_ = cells;
    if (cells_ == cells && cells_ > first_) return {};
    const std::string found = text_.Place() + ": found " + std::to_string(cells - first_) + " cells from column " +
                              std::to_string(layout_.first_column) + " on, expected ";
    if (cells_ == first_) return Error{found + "at least one" + text_.WrongSeparator()};
    return Error{found + std::to_string(cells_ - first_) + " as before" + (cells < cells_ ? text_.CutOff() : "")};
  }

  // A header is told by the angle's cell: a name, no number.
  bool IsHeader(const std::vector<std::string>& row) const {
    if (angle_ >= row.size() || ParseNumber(row[angle_]).kind != NumberKind::kText) return false;
    const auto initial = static_cast<unsigned char>(row[angle_].front());
    return initial >= 0x80 || std::isalpha(initial) != 0;  // a broken number like 12.3.4 is no name
  }

  const WideLayout layout_;
  bool has_angle_, by_profile_ = false;
  std::optional<double> first_profile_;
  size_t angle_, first_;  // columns, 0-based
  double angle_factor_, across_factor_, value_factor_;
  size_t cells_ = 0, trailing_ = 0;  // of every row; empty ones behind its last separator
};

}  // namespace

Result<std::unique_ptr<ScanReader>> OpenCsv(const ScanFormat& format, DecodedFile file) {
  return OpenText<LongReader>(format, DelimitedText::Open(std::move(file)));
}
Result<std::unique_ptr<ScanReader>> OpenWideCsv(const ScanFormat& format) {
  return OpenText<WideReader>(format, DelimitedText::Open(format.path));
}

}  // namespace scancal
