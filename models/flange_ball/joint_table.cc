#include "models/flange_ball/joint_table.h"
#include <fmt/format.h>
#include <cmath>
#include <numbers>
#include "io/csv_fields.h"
#include "io/message.h"
#include "io/scan_columns.h"
#include "io/text_lines.h"

namespace scancal {
namespace {

constexpr double kTurn_rad = 2 * std::numbers::pi;
constexpr double kLeastMotion_rad = 0.1;  // radians read as degrees: 6 rad look like this

std::string Joint(size_t k) { return "q" + std::to_string(k + 1); }

class JointReader {
 public:
  JointReader(const JointFormat& format, size_t joints, TextLines text)
      : format_(format), joints_(joints), text_(std::move(text)) {}

  Result<std::vector<std::vector<double>>> Run() {
    std::vector<std::string> names = format_.columns;
    for (;;) {
      SCANCAL_ASSIGN_OR_RETURN(const auto line, text_.TakeLine());
      if (!line) break;
      ++line_;
      if (IsWithoutCells(*line)) continue;
      const std::vector<CsvField> cells = SplitCells(*line);
      if (columns_.empty()) {
        const bool has_header = names.empty();
        if (has_header)
          for (const CsvField& cell : cells) names.push_back(cell.text);
        SCANCAL_RETURN_IF_ERROR(Choose(names, *line));
        if (has_header) continue;
      }
      SCANCAL_RETURN_IF_ERROR(Read(*line, cells));
    }
    if (poses_.size() < 2)
      return Error{fmt::format("{}: found {} poses, expected two or more", text_.name(), poses_.size())};
    SCANCAL_RETURN_IF_ERROR(CheckUnit());
    return std::move(poses_);
  }

 private:
  std::string Place() const { return text_.name() + ":" + std::to_string(line_); }

  Result<void> Choose(const std::vector<std::string>& names, std::string_view line) {
    ScanFormat format;
    format.units = format_.units;
    for (size_t k = 0; k < joints_; ++k) format.columns.push_back({Joint(k), Dimension::kAngle, true});
    auto chosen = ChooseColumns(format, names, Place());
    if (!chosen.ok())
      return Error{chosen.error().message + WrongSeparator(line) +
                   (format_.columns.empty() ? "; if the file has no header, declare columns: [q1, q2, ...]" : "")};
    columns_ = std::move(*chosen);
    cells_ = names.size();
    return {};
  }

  Result<void> Read(std::string_view line, const std::vector<CsvField>& cells) {
    if (cells.size() != cells_)
      return Error{fmt::format("{}: found {} cells, expected {}", Place(), cells.size(), cells_) +
                   WrongSeparator(line)};
    std::vector<double>& pose = poses_.emplace_back();
    for (const ChosenColumn& column : columns_) {
      const CsvField& cell = cells[column.index];
      const ParsedNumber number = ParseNumber(cell.text);
      if (number.kind != NumberKind::kNumber)
        return Error{fmt::format("{}:{}: {}: found {}, expected a finite number", Place(), cell.column, column.name,
                                 Quoted(cell.text))};
      pose.push_back(number.value * column.factor);
      if (std::abs(pose.back()) > 2 * kTurn_rad)
        return Error{
            fmt::format("{}:{}: {}: that is {:.4g} rad, expected two turns at most; are these degrees? See "
                        "units: angle, or name the column {}_deg",
                        Place(), cell.column, column.name, pose.back(), column.name)};
    }
    return {};
  }

  Result<void> CheckUnit() const {
    double largest = 0;
    for (const std::vector<double>& pose : poses_)
      for (const double angle : pose) largest = std::max(largest, std::abs(angle));
    if (largest > kLeastMotion_rad) return {};
    return Error{
        fmt::format("{}: all joint angles lie within {:.3g} deg, expected a robot that moves; are these "
                    "radians? See units: angle, or name the columns q1_rad ...",
                    text_.name(), largest * 360 / kTurn_rad)};
  }

  const JointFormat& format_;
  size_t joints_;
  TextLines text_;
  size_t cells_ = 0;  // of a line
  int64_t line_ = 0;
  std::vector<ChosenColumn> columns_;
  std::vector<std::vector<double>> poses_;
};

}  // namespace

Result<std::vector<std::vector<double>>> ReadJoints(const std::filesystem::path& path, const JointFormat& format,
                                                    size_t joints) {
  SCANCAL_ASSIGN_OR_RETURN(TextLines text, TextLines::Open(path));
  return JointReader(format, joints, std::move(text)).Run();
}

}  // namespace scancal
