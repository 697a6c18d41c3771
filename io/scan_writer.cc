#include "io/scan_writer.h"
#include <algorithm>
#include <utility>
#include "io/npy.h"
#include "io/output_file.h"

namespace scancal {
namespace {

// Of a file with so many points; always as long.
using ScanHeader = std::string (*)(const std::vector<std::string>& names, int64_t points);

std::string Between(const std::vector<std::string>& words, char between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : std::string(1, between)) + word;
  return text;
}

std::string Padding(int64_t points) { return std::string(20 - std::to_string(points).size(), ' '); }

std::string CsvHeader(const std::vector<std::string>& names, int64_t /*points*/) { return Between(names, ',') + "\n"; }

std::string NpyHeaderOf(const std::vector<std::string>& names, int64_t points) {
  return MakeNpyHeader(points, static_cast<int64_t>(names.size()));
}

std::string PlyHeader(const std::vector<std::string>& names, int64_t points) {
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment " + Padding(points) + "\nelement vertex " +
                       std::to_string(points) + "\n";
  for (const std::string& name : names) header += "property double " + name + "\n";
  return header + "end_header\n";
}

std::string PcdHeader(const std::vector<std::string>& names, int64_t points) {
  const auto each = [&](const char* word) { return Between(std::vector<std::string>(names.size(), word), ' ') + "\n"; };
  const std::string count = std::to_string(points), padding = Padding(points);
  return "# .PCD v0.7 - Point Cloud Data file format\n#" + padding + padding + "\nVERSION 0.7\nFIELDS " +
         Between(names, ' ') + "\nSIZE " + each("8") + "TYPE " + each("F") + "COUNT " + each("1") + "WIDTH " + count +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n";
}

class RecordWriter : public ScanWriter {
 public:
  RecordWriter(OutputFile file, const std::vector<ScanColumn>& columns, ScanHeader header)
      : file_(std::move(file)), columns_(columns), header_(header) {}

  Result<void> Write(const ScanBatch& batch) override {
    if (names_.empty()) {
      for (const std::string& name : batch.names) names_.push_back(name + UnitOf(name));
      SCANCAL_RETURN_IF_ERROR(file_.Write(header_(names_, 0)));
    }
    record_.clear();
    for (size_t i = 0; i < batch.size(); ++i)
      for (size_t k = 0; k < batch.columns.size(); ++k) {
        if (header_ != &CsvHeader) {
          AppendBytes(&record_, batch.columns[k][i]);
        } else {
          AppendText(&record_, batch.columns[k][i]);
          record_ += k + 1 < batch.columns.size() ? ',' : '\n';
        }
      }
    points_ += static_cast<int64_t>(batch.size());
    return file_.Write(record_);
  }

  Result<void> Commit() override {
    SCANCAL_RETURN_IF_ERROR(file_.Rewrite(0, header_(names_, points_)));
    return file_.Commit();
  }

 private:
  const char* UnitOf(const std::string& name) const {
    const auto is_it = [&](const ScanColumn& column) { return column.name == name; };
    const auto found = std::find_if(columns_.begin(), columns_.end(), is_it);
    const Dimension dimension = found == columns_.end() ? Dimension::kNone : found->dimension;
    return dimension == Dimension::kLength ? "_mm" : dimension == Dimension::kAngle ? "_rad" : "";
  }

  OutputFile file_;
  std::vector<ScanColumn> columns_;
  ScanHeader header_;
  std::string record_;
};

}  // namespace

Result<std::unique_ptr<ScanWriter>> ScanWriter::Create(const std::filesystem::path& path,
                                                       const std::vector<ScanColumn>& columns) {
  const std::string extension = path.extension().string();
  const ScanHeader header = extension == ".csv"   ? &CsvHeader
                            : extension == ".npy" ? &NpyHeaderOf
                            : extension == ".ply" ? &PlyHeader
                            : extension == ".pcd" ? &PcdHeader
                                                  : nullptr;
  if (header == nullptr)
    return Error{path.string() + ": found the extension '" + extension + "', expected .csv, .npy, .ply or .pcd"};
  SCANCAL_ASSIGN_OR_RETURN(OutputFile file, OutputFile::Create(path));
  return std::unique_ptr<ScanWriter>(std::make_unique<RecordWriter>(std::move(file), columns, header));
}

}  // namespace scancal
