#include "io/file_kind.h"
#include <algorithm>
#include "io/decoded_file.h"
#include "io/message.h"

namespace scancal {
namespace {

constexpr size_t kSeen = size_t{1} << 18;
const FileKind* const kKinds[] = {&kGocator, &kLjV, &kLjX, &kHeightImage, &kPly, &kPcd, &kRos1, &kRos2};

}  // namespace

std::string OptionalFileKinds() {
  std::vector<std::string> kinds;
#ifdef SCANCAL_SQLITE
  kinds.emplace_back("ROS 2 bags");
#endif
#ifdef SCANCAL_TIFF
  kinds.emplace_back("TIFF");
#endif
  return Listed(kinds);
}

const FileKind* NamedFileKind(std::string_view name) {
  const auto is_it = [&](const FileKind* kind) { return kind->name == name; };
  const auto found = std::find_if(std::begin(kKinds), std::end(kKinds), is_it);
  return found == std::end(kKinds) ? nullptr : *found;
}

std::vector<std::string> FileKindNames() {
  std::vector<std::string> names;
  for (const FileKind* kind : kKinds) names.emplace_back(kind->name);
  return names;
}

std::string TriedFileKinds() {
  std::vector<std::string> titles;
  for (const FileKind* kind : kKinds) titles.emplace_back(kind->title);
  return "; tried too: " + Listed(titles);
}

bool IsReadOnce(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_fifo(path, ignored);
}

Result<const FileKind*> FindFileKind(const ScanFormat& format) {
  const FileKind* const named = NamedFileKind(format.kind);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(ArchiveOf(format.path), ignored)) return named;
  const auto start = FirstBytes(format.path, kSeen);
  if (!start.ok()) return named;  // who opens it next says why
  const std::string_view text = WithoutByteOrderMark(*start);
  const auto is_it = [&](const FileKind* kind) { return kind->is_it(text, format); };
  if (named != nullptr && is_it(named)) return named;
  const auto found = std::find_if(std::begin(kKinds), std::end(kKinds), is_it);
  const FileKind* const kind = found == std::end(kKinds) ? nullptr : *found;
  if (named == nullptr) return kind;
  const bool image = StartsAsImage(text);
  if ((kind == nullptr && !image) || (named == &kLjX && image)) return named;
  return Error{format.path.string() + ": found " + (kind != nullptr ? kind->title : "an array or an image") +
               ", expected " + named->title + " as format: " + named->name + " says"};
}

Result<std::string> FirstBytes(const std::filesystem::path& path, size_t most) {
  if (IsReadOnce(path))
    return Error{path.string() +
                 ": found a pipe, expected a file: its first bytes tell what it is; of a pipe only text "
                 "and .npy are read"};
  SCANCAL_ASSIGN_OR_RETURN(DecodedFile file, DecodedFile::Open(path));
  std::string start(most, '\0');
  SCANCAL_ASSIGN_OR_RETURN(const size_t count, file.Read(start.data(), start.size()));
  start.resize(count);
  return start;
}

std::string_view TakeFirstLine(std::string_view* text) {
  const std::string_view line = text->substr(0, text->find('\n'));
  text->remove_prefix(std::min(text->size(), line.size() + 1));
  return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
}

}  // namespace scancal
