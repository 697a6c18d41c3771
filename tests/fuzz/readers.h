// The readers of files, each as a function of any bytes: it ends, with a value or one sentence.
#pragma once
#include <sys/mman.h>
#include <unistd.h>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include "io/dataset.h"
#include "io/json_file.h"
#include "io/scan.h"
#include "io/table.h"
#include "io/urdf.h"

namespace scancal {

// A file in memory with these bytes.
class FileOf {
 public:
  explicit FileOf(std::string_view bytes) : descriptor_(::memfd_create("fuzz", 0)) {
    if (descriptor_ < 0 || ::write(descriptor_, bytes.data(), bytes.size()) < 0) std::abort();
  }
  FileOf(const FileOf&) = delete;
  FileOf& operator=(const FileOf&) = delete;
  ~FileOf() { ::close(descriptor_); }
  std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

inline void ReadToItsEnd(const ScanFormat& format) {
  auto reader = ScanReader::Open(format);
  ScanBatch batch;
  while (reader.ok()) {
    const auto more = (*reader)->Next(&batch);
    if (!more.ok() || !*more) break;
    for (const auto& column : batch.columns)
      if (column.size() != batch.size()) std::abort();
  }
}

// The first byte chooses what is declared of the rest.
inline void ReadAsScan(std::string_view bytes) {
  if (bytes.empty()) return;
  const auto choice = static_cast<unsigned char>(bytes[0]);
  const FileOf file(bytes.substr(1));
  ScanFormat format;
  format.path = file.path();
  format.columns = {{"angle", Dimension::kAngle},
                    {"y", Dimension::kLength},
                    {"z", Dimension::kLength},
                    {"profile", Dimension::kNone, false}};
  if (choice & 1U) format.npy_columns = {"angle", "y", "z"};
  if (choice & 2U) format.layout = WideLayout{.value = "y", .across = "z"};
  if (choice & 4U) format.text.missing = {"no echo"};
  if (choice & 8U) format.text.where = {{"z", "1"}};
  if (choice & 16U) format.angle = LoggedAngle{.wrap = 360, .is_step = (choice & 32U) != 0, .first = {}, .echo = {}};
  if (choice & 64U) format.text.decimal = ',';
  if (choice & 128U) format.lines = {2, 5};
  ReadToItsEnd(format);
}

inline void ReadAsTable(std::string_view bytes) {
  const FileOf file(bytes);
  const std::vector<TableColumn> columns = {
      {"pose"}, {"x", Cells::kNumber, Dimension::kLength}, {"u", Cells::kNumberOrNothing, Dimension::kLength, false}};
  const auto named = Table::Read(file.path(), columns, {});
  const auto nameless = Table::Read(file.path(), columns, {}, {"pose", "x", "u"});
  if (named.ok()) (void)named->Wrong(named->rows() - 1, "x", "?");
}

inline void ReadAsArray(std::string_view bytes) {
  const FileOf file(bytes);
  const auto link = std::filesystem::temp_directory_path() / ("fuzz" + std::to_string(::getpid()) + ".npy");
  std::error_code ignored;
  std::filesystem::remove(link, ignored);
  std::filesystem::create_symlink(file.path(), link, ignored);
  ScanFormat format;
  format.path = link;
  format.columns = {{"angle", Dimension::kAngle}, {"y", Dimension::kLength}, {"z", Dimension::kLength}};
  format.npy_columns = {"angle", "y", "z"};
  ReadToItsEnd(format);
  std::filesystem::remove(link, ignored);
}

// Files of an instrument; the first byte as in ReadAsScan.
inline void ReadAsKind(std::string_view bytes, const char* kind) {
  if (bytes.empty()) return;
  const auto choice = static_cast<unsigned char>(bytes[0]);
  const FileOf file(bytes.substr(1));
  ScanFormat format;
  format.path = file.path();
  if (choice & 1U) format.kind = kind;
  format.columns = {{"angle", Dimension::kAngle},
                    {"y", Dimension::kLength, false},
                    {"z", Dimension::kLength, false},
                    {"profile", Dimension::kNone, false}};
  if (choice & 2U)
    format.layout = WideLayout{.value = "y",
                               .across = "z",
                               .angle_column = 0,
                               .first_column = 1,
                               .start = -1,
                               .step = 0.5,
                               .image = true,
                               .scaled = true};
  if (choice & 8U) format.text.where = {{"Source", "0"}};
  if (choice & 16U)
    format.angle = LoggedAngle{.column = "Encoder", .is_step = (choice & 32U) != 0, .first = {}, .echo = {}};
  if (choice & 128U) format.lines = {2, 20};
  ReadToItsEnd(format);
}
inline void ReadAsGocator(std::string_view bytes) { ReadAsKind(bytes, "gocator"); }
inline void ReadAsLjV(std::string_view bytes) { ReadAsKind(bytes, "lj-v"); }
inline void ReadAsLjX(std::string_view bytes) { ReadAsKind(bytes, "lj-x"); }
inline void ReadAsHeightImage(std::string_view bytes) { ReadAsKind(bytes, "image"); }
inline void ReadAsTiff(std::string_view bytes) { ReadAsKind(bytes, "image"); }
inline void ReadAsRos1(std::string_view bytes) { ReadAsKind(bytes, "ros1"); }
// SQLite opens files by their names.
inline void ReadAsRos2(std::string_view bytes) {
  const std::filesystem::path path = "/dev/shm/fuzz" + std::to_string(::getpid()) + ".db3";
  std::ofstream(path, std::ios::binary) << bytes;
  ScanFormat format;
  format.path = path;
  format.kind = "ros2";
  format.columns = {{"angle", Dimension::kAngle}};
  ReadToItsEnd(format);
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}
inline void ReadAsPly(std::string_view bytes) { ReadAsKind(bytes, "ply"); }
inline void ReadAsPcd(std::string_view bytes) { ReadAsKind(bytes, "pcd"); }

inline void ReadAsDeclaration(std::string_view bytes) {
  auto dataset = ParseDataset(std::string(bytes), "dataset.yaml", "dataset.yaml");
  if (!dataset.ok()) return;
  ScanFormat format;
  format.columns = {{"angle", Dimension::kAngle}, {"y", Dimension::kLength}};
  ReadFormat(dataset->yaml, {}, &format);
  (void)dataset->yaml.Finish();
}

inline void ReadAsRobot(std::string_view bytes) {
  const auto joints = ReadUrdf(bytes, "arm.urdf", "", "tool0");
  if (joints.ok() && joints->empty()) std::abort();
}

inline void ReadAsResult(std::string_view bytes) {
  const FileOf file(bytes);
  (void)ReadJson(file.path());
  (void)FromBase64(bytes);
}

struct FuzzedReader {
  const char* name;
  void (*read)(std::string_view bytes);
};
inline constexpr FuzzedReader kFuzzedReaders[] = {{"scan", &ReadAsScan},       {"table", &ReadAsTable},
                                                  {"array", &ReadAsArray},     {"declaration", &ReadAsDeclaration},
                                                  {"robot", &ReadAsRobot},     {"result", &ReadAsResult},
                                                  {"gocator", &ReadAsGocator}, {"ljv", &ReadAsLjV},
                                                  {"ljx", &ReadAsLjX},         {"image", &ReadAsHeightImage},
                                                  {"ply", &ReadAsPly},         {"pcd", &ReadAsPcd},
                                                  {"tiff", &ReadAsTiff},       {"ros1", &ReadAsRos1},
                                                  {"ros2", &ReadAsRos2}};

}  // namespace scancal
