#include "io/point_list.h"
#include <algorithm>
#include "io/message.h"
#include "io/number.h"

namespace scancal {
namespace {

std::vector<std::string_view> Split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (size_t from = 0; from <= text.size();) {
    const size_t end = std::min(text.find(separator, from), text.size());
    parts.push_back(WithoutBlanks(text.substr(from, end - from)));
    from = end + 1;
  }
  return parts;
}

std::vector<std::string> NamesOf(const std::vector<ScanColumn>& columns) {
  std::vector<std::string> names;
  for (const ScanColumn& column : columns) names.push_back(column.name);
  return names;
}

Result<std::vector<double>> ParsePoint(std::string_view text, const std::vector<ScanColumn>& columns,
                                       const Units& units) {
  const std::vector<std::string_view> cells = Split(text, ',');
  const std::string place = "point " + Quoted(text) + ": ";
  if (cells.size() != columns.size())
    return Error{place + "found " + std::to_string(cells.size()) + (cells.size() == 1 ? " value" : " values") +
                 ", expected " + std::to_string(columns.size()) + ": " + Listed(NamesOf(columns))};
  std::vector<double> point;
  for (size_t k = 0; k < cells.size(); ++k) {
    const ParsedNumber number = ParseNumber(cells[k]);
    if (number.kind != NumberKind::kNumber)
      return Error{place + columns[k].name + ": found " + Quoted(cells[k]) + ", expected a finite number"};
    point.push_back(number.value * units.Of(columns[k].dimension));
  }
  return point;
}

Result<void> AppendFile(const PointRequest& request, const std::vector<ScanColumn>& columns,
                        std::vector<std::vector<double>>* points) {
  ScanFormat format;
  format.path = request.file;
  format.units = request.units;
  format.columns = columns;
  format.npy_columns = NamesOf(columns);
  SCANCAL_ASSIGN_OR_RETURN(ScanReader reader, ScanReader::Open(format));
  ScanBatch batch;
  for (;;) {
    SCANCAL_ASSIGN_OR_RETURN(const bool more, reader.Next(&batch));
    if (!more) break;
    for (size_t i = 0; i < batch.size(); ++i) {
      std::vector<double>& point = points->emplace_back();
      for (const ScanColumn& column : columns) point.push_back(batch.columns[batch.Find(column.name)][i]);
    }
  }
  if (reader.missing() > 0)
    return Error{request.file.string() + ": found " + std::to_string(reader.missing()) +
                 " points with a missing number, expected all of " + Listed(NamesOf(columns))};
  return {};
}

}  // namespace

Result<std::vector<std::vector<double>>> ReadPoints(const PointRequest& request,
                                                    const std::vector<ScanColumn>& columns) {
  std::vector<std::vector<double>> points;
  for (const std::string_view text : Split(request.typed, ';')) {
    if (text.empty()) continue;
    SCANCAL_ASSIGN_OR_RETURN(points.emplace_back(), ParsePoint(text, columns, request.units));
  }
  if (!request.file.empty()) SCANCAL_RETURN_IF_ERROR(AppendFile(request, columns, &points));
  if (points.empty()) return Error{"no points: expected typed ones or a file, each with " + Listed(NamesOf(columns))};
  return points;
}

Result<Units> ParseUnits(const std::string& text) {
  const std::vector<std::string_view> names = Split(text, ',');
  Units units;
  const auto length = UnitSize(names.front(), Dimension::kLength), angle = UnitSize(names.back(), Dimension::kAngle);
  if (names.size() != 2 || !length || !angle)
    return Error{"units: found " + Quoted(text) + ", expected a length and an angle: mm, m or um, and deg or rad"};
  units.length = names.front();
  units.angle = names.back();
  units.length_in_mm = *length;
  units.angle_in_rad = *angle;
  return units;
}

}  // namespace scancal
