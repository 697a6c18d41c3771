#include "io/points.h"
#include <algorithm>
#include <stdexcept>
#include <utility>
#include "io/message.h"
#include "io/npy.h"
#include "io/number.h"
#include "io/output_file.h"

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
  SCANCAL_ASSIGN_OR_RETURN(const auto reader, ScanReader::Open(format));
  ScanBatch batch;
  for (;;) {
    SCANCAL_ASSIGN_OR_RETURN(const bool more, reader->Next(&batch));
    if (!more) break;
    for (size_t i = 0; i < batch.size(); ++i) {
      std::vector<double>& point = points->emplace_back();
      for (const ScanColumn& column : columns) point.push_back(batch.columns[batch.Find(column.name)][i]);
    }
  }
  if (reader->missing() > 0)
    return Error{request.file.string() + ": found " + std::to_string(reader->missing()) +
                 " points with a missing number, expected all of " + Listed(NamesOf(columns))};
  return {};
}

using Point = std::array<double, 3>;

// Names of what stands beside the coordinates, with a unit: "u_x", "_mm".
std::vector<std::pair<std::string, std::string>> NamesOf(const PointExtras& wants) {
  std::vector<std::pair<std::string, std::string>> names;
  if (wants.u)
    for (const char* axis : {"x", "y", "z"}) names.emplace_back(std::string("u_") + axis, "_mm");
  if (wants.covariance)
    for (const char* axes : {"xx", "xy", "xz", "yy", "yz", "zz"})
      names.emplace_back(std::string("cov_") + axes, "_mm2");
  return names;
}

// What the formats share: records one after the other behind a header that may need the number of points.
class Writer : public PointCloudWriter {
 public:
  Writer(OutputFile file, const PointExtras& wants) : file_(std::move(file)) { wants_ = wants; }
  virtual std::string Header(int64_t points) const = 0;  // always as long
  virtual void Append(std::string* record, std::span<const double> numbers, int scan) const = 0;

  Result<void> Start() { return file_.Write(Header(0)); }

  Result<void> Write(std::span<const Point> points_mm, int scan, std::span<const double> beside) final {
    const size_t extras = wants_.size();
    if (beside.size() != extras * points_mm.size()) throw std::logic_error("numbers beside points: not as declared");
    for (size_t i = 0; i < points_mm.size(); ++i) {
      record_.clear();
      numbers_.assign(points_mm[i].begin(), points_mm[i].end());
      numbers_.insert(numbers_.end(), beside.begin() + static_cast<ptrdiff_t>(extras * i),
                      beside.begin() + static_cast<ptrdiff_t>(extras * (i + 1)));
      Append(&record_, numbers_, scan);
      SCANCAL_RETURN_IF_ERROR(file_.Write(record_));
    }
    points_ += static_cast<int64_t>(points_mm.size());
    return {};
  }

  Result<void> Commit() final {
    SCANCAL_RETURN_IF_ERROR(file_.Rewrite(0, Header(points_)));
    return file_.Commit();
  }

 private:
  OutputFile file_;
  std::string record_;
  std::vector<double> numbers_;
  int64_t points_ = 0;
};

class PlyWriter : public Writer {
 public:
  using Writer::Writer;
  std::string Header(int64_t points) const override {
    const std::string count = std::to_string(points);
    const std::string padding(20 - count.size(), ' ');  // in a comment, where no reader minds
    std::string header = "ply\nformat binary_little_endian 1.0\ncomment x, y, z in mm" + padding + "\nelement vertex " +
                         count + "\nproperty double x\nproperty double y\nproperty double z\n";
    for (const auto& [name, unit] : NamesOf(wants_)) header += "property double " + name + "\n";
    return header + "property int scan\nend_header\n";
  }
  void Append(std::string* record, std::span<const double> numbers, int scan) const override {
    for (const double number : numbers) AppendBytes(record, number);
    AppendBytes(record, scan);
  }
};

class CsvWriter : public Writer {
 public:
  using Writer::Writer;
  std::string Header(int64_t /*points*/) const override {
    std::string header = "x_mm,y_mm,z_mm,";
    for (const auto& [name, unit] : NamesOf(wants_)) header += name + unit + ",";
    return header + "scan\n";
  }
  void Append(std::string* record, std::span<const double> numbers, int scan) const override {
    for (const double number : numbers) {
      AppendText(record, number);
      *record += ',';
    }
    AppendText(record, scan);
    *record += '\n';
  }
};

class NpyWriter : public Writer {
 public:
  using Writer::Writer;
  std::string Header(int64_t points) const override {
    return MakeNpyHeader(points, 3 + static_cast<int>(wants_.size()));
  }
  void Append(std::string* record, std::span<const double> numbers, int /*scan*/) const override {
    for (const double number : numbers) AppendBytes(record, number);
  }
};

template <class Format>
Result<std::unique_ptr<PointCloudWriter>> Start(const std::filesystem::path& path, const PointExtras& wants) {
  SCANCAL_ASSIGN_OR_RETURN(OutputFile file, OutputFile::Create(path));
  auto writer = std::make_unique<Format>(std::move(file), wants);
  SCANCAL_RETURN_IF_ERROR(writer->Start());
  return std::unique_ptr<PointCloudWriter>(std::move(writer));
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

Result<std::unique_ptr<PointCloudWriter>> CreatePointCloud(const std::filesystem::path& path,
                                                           const PointExtras& wants) {
  const std::string extension = path.extension().string();
  if (extension == ".ply") return Start<PlyWriter>(path, wants);
  if (extension == ".csv") return Start<CsvWriter>(path, wants);
  if (extension == ".npy") return Start<NpyWriter>(path, wants);
  return Error{path.string() + ": found the extension '" + extension + "', expected .ply, .csv or .npy"};
}

}  // namespace scancal
