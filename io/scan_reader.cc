#include "io/scan_reader.h"
#include <algorithm>
#include <cctype>
#include <utility>
#include "io/scan_source.h"

namespace scancal {
namespace {

bool IsNpy(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".npy";
}

Result<std::unique_ptr<ScanSource>> OpenSource(const ScanFormat& format) {
  if (format.layout) return OpenWideCsv(format);
  return IsNpy(format.path) ? OpenNpy(format) : OpenCsv(format);
}

}  // namespace

Error WrongCell(const std::string& place, const std::string& name, NumberKind kind, const std::string& found) {
  const char* expected = kind == NumberKind::kInfinite   ? ", expected a finite number; a missing point is nan or empty"
                         : kind == NumberKind::kTooLarge ? ", expected a number within +-1.8e308"
                                                         : ", expected a number";
  return Error{place + ": " + name + ": found " + found + expected};
}

Error NoPoints(const ScanFormat& format, int64_t lines_in_file) {
  const std::string name = format.path.string();
  if (lines_in_file == 0) return Error{name + ": no points: the file is empty"};
  if (!format.lines) return Error{name + ": no points: found at most a header and comments, expected lines of data"};
  return Error{name + ": no points in the lines " + std::to_string(format.lines->first) + " to " +
               std::to_string(format.lines->second)};
}

int ScanBatch::Find(std::string_view name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

class ScanReader::Impl {
 public:
  explicit Impl(std::unique_ptr<ScanSource> source) : source_(std::move(source)) {}
  ScanSource& source() { return *source_; }

 private:
  std::unique_ptr<ScanSource> source_;
};

Result<ScanReader> ScanReader::Open(const ScanFormat& format) {
  SCANCAL_ASSIGN_OR_RETURN(auto source, OpenSource(format));
  return ScanReader(std::make_unique<Impl>(std::move(source)));
}

ScanReader::ScanReader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ScanReader::ScanReader(ScanReader&&) noexcept = default;
ScanReader& ScanReader::operator=(ScanReader&&) noexcept = default;
ScanReader::~ScanReader() = default;

Result<bool> ScanReader::Next(ScanBatch* batch) { return impl_->source().Next(batch); }
int64_t ScanReader::missing() const { return impl_->source().missing(); }
int64_t ScanReader::bytes_read() const { return impl_->source().bytes_read(); }
int64_t ScanReader::bytes_total() const { return impl_->source().bytes_total(); }

}  // namespace scancal
