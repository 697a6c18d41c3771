#include "io/point_cloud.h"
#include <charconv>
#include <cstring>
#include <utility>
#include "io/npy_header.h"
#include "io/output_file.h"

namespace scancal {
namespace {

using Point = std::array<double, 3>;

template <class Number>
void AppendBytes(std::string* bytes, Number value) {  // little endian, like the machine
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes->append(raw, sizeof value);
}

template <class Number>
void AppendText(std::string* text, Number value) {
  char digits[32];
  const auto [end, error] = std::to_chars(std::begin(digits), std::end(digits), value);
  text->append(digits, end);
}

// What the formats share: records one after the other behind a header that may need the number of points.
class Writer : public PointCloudWriter {
 public:
  explicit Writer(OutputFile file) : file_(std::move(file)) {}
  virtual std::string Header(int64_t points) const = 0;  // always as long
  virtual void Append(std::string* record, const Point& point, int scan) const = 0;

  Result<void> Start() { return file_.Write(Header(0)); }

  Result<void> Write(std::span<const Point> points_mm, int scan) final {
    for (const Point& point : points_mm) {
      record_.clear();
      Append(&record_, point, scan);
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
  int64_t points_ = 0;
};

class PlyWriter : public Writer {
 public:
  using Writer::Writer;
  std::string Header(int64_t points) const override {
    const std::string count = std::to_string(points);
    const std::string padding(20 - count.size(), ' ');  // in a comment, where no reader minds
    return "ply\nformat binary_little_endian 1.0\ncomment x, y, z in mm" + padding + "\nelement vertex " + count +
           "\nproperty double x\nproperty double y\nproperty double z\nproperty int scan\nend_header\n";
  }
  void Append(std::string* record, const Point& point, int scan) const override {
    for (const double coordinate : point) AppendBytes(record, coordinate);
    AppendBytes(record, scan);
  }
};

class CsvWriter : public Writer {
 public:
  using Writer::Writer;
  std::string Header(int64_t /*points*/) const override { return "x_mm,y_mm,z_mm,scan\n"; }
  void Append(std::string* record, const Point& point, int scan) const override {
    for (const double coordinate : point) {
      AppendText(record, coordinate);
      *record += ',';
    }
    AppendText(record, scan);
    *record += '\n';
  }
};

class NpyWriter : public Writer {
 public:
  using Writer::Writer;
  std::string Header(int64_t points) const override { return MakeNpyHeader(points, 3); }
  void Append(std::string* record, const Point& point, int /*scan*/) const override {
    for (const double coordinate : point) AppendBytes(record, coordinate);
  }
};

template <class Format>
Result<std::unique_ptr<PointCloudWriter>> Start(const std::filesystem::path& path) {
  SCANCAL_ASSIGN_OR_RETURN(OutputFile file, OutputFile::Create(path));
  auto writer = std::make_unique<Format>(std::move(file));
  SCANCAL_RETURN_IF_ERROR(writer->Start());
  return std::unique_ptr<PointCloudWriter>(std::move(writer));
}

}  // namespace

Result<std::unique_ptr<PointCloudWriter>> CreatePointCloud(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".ply") return Start<PlyWriter>(path);
  if (extension == ".csv") return Start<CsvWriter>(path);
  if (extension == ".npy") return Start<NpyWriter>(path);
  return Error{path.string() + ": found the extension '" + extension + "', expected .ply, .csv or .npy"};
}

}  // namespace scancal
