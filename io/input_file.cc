#include "io/input_file.h"
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <utility>
#include <vector>
#include "io/message.h"

namespace scancal {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> NamesIn(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  fs::directory_iterator entry(folder.empty() ? "." : folder, ignored);
  for (; !ignored && entry != fs::directory_iterator(); entry.increment(ignored)) {
    names.push_back(entry->path().filename().string());
  }
  return names;
}

Error CannotOpen(const fs::path& path, int error_number) {
  std::string message = path.string() + ": cannot be opened: " + SystemMessage(error_number);
  if (error_number == ENOENT) {
    const std::string nearest = Nearest(path.filename().string(), NamesIn(path.parent_path()));
    message = path.string() + ": no such file";
    if (!nearest.empty()) message += "; did you mean '" + nearest + "'?";
  }
  return Error{std::move(message)};
}

}  // namespace

Result<InputFile> InputFile::Open(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return CannotOpen(path, errno);
  InputFile file(path.string(), descriptor);
  struct stat status = {};
  if (::fstat(descriptor, &status) != 0) return CannotOpen(path, errno);
  if (S_ISDIR(status.st_mode)) return Error{path.string() + ": found a folder, expected a file"};
  file.regular_ = S_ISREG(status.st_mode);
  file.size_ = file.regular_ ? status.st_size : 0;
  return file;
}

InputFile::InputFile(InputFile&& other) noexcept { *this = std::move(other); }

InputFile& InputFile::operator=(InputFile&& other) noexcept {
  std::swap(name_, other.name_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(size_, other.size_);
  std::swap(regular_, other.regular_);
  return *this;
}

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<size_t> InputFile::Read(char* buffer, size_t size) {
  size_t filled = 0;
  while (filled < size) {
    const ssize_t count = ::read(descriptor_, buffer + filled, size - filled);
    if (count == 0) break;
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return Error{name_ + ": cannot be read: " + SystemMessage(errno)};
    filled += static_cast<size_t>(count);
  }
  return filled;
}

Result<void> InputFile::Skip(int64_t bytes) {
  if (::lseek(descriptor_, bytes, SEEK_CUR) < 0) return Error{name_ + ": cannot be read: " + SystemMessage(errno)};
  return {};
}

Result<std::string> ReadText(const fs::path& path) {
  SCANCAL_ASSIGN_OR_RETURN(InputFile file, InputFile::Open(path));
  constexpr size_t kBlock = size_t{1} << 16;
  std::string text;
  for (size_t filled = 0;;) {
    text.resize(filled + kBlock);
    SCANCAL_ASSIGN_OR_RETURN(const size_t count, file.Read(text.data() + filled, kBlock));
    filled += count;
    if (count < kBlock) {
      text.resize(filled);
      return text;
    }
  }
}

}  // namespace scancal
