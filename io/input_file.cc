#include "io/input_file.h"
#include <fcntl.h>
#include <openssl/evp.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>
#include <utility>
#include <vector>
#include "io/decoded_file.h"
#include "io/message.h"

namespace scancal {
namespace {

namespace fs = std::filesystem;
constexpr int64_t kLongestPipe = int64_t{1} << 36;  // bytes

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

using Context = std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)>;

// Null if OpenSSL refuses the algorithm.
Context Begin() {
  Context context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  if (context && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) != 1) context.reset();
  return context;
}

Result<std::string> Finish(const Context& context, bool ok, const std::string& name) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest = {};
  unsigned size = 0;
  ok = ok && EVP_DigestFinal_ex(context.get(), digest.data(), &size) == 1;
  if (!ok) return Error{name + ": its SHA-256 cannot be computed: OpenSSL refuses the algorithm"};
  std::string text;
  for (unsigned i = 0; i < size; ++i) {
    constexpr char kDigits[] = "0123456789abcdef";
    text += {kDigits[digest[i] >> 4U], kDigits[digest[i] & 15U]};
  }
  return text;
}

}  // namespace

Result<InputFile> InputFile::Open(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe has no writer yet
  if (descriptor < 0) return CannotOpen(path, errno);
  InputFile file(path.string(), descriptor);
  struct stat status = {};
  if (::fstat(descriptor, &status) != 0) return CannotOpen(path, errno);
  if (S_ISDIR(status.st_mode)) return Error{path.string() + ": found a folder, expected a file"};
  if (S_ISCHR(status.st_mode) && path == "/dev/stdin")
    return Error{"the standard input is closed or a terminal, expected a file or a pipe: scancal ... < left.csv"};
  if (S_ISCHR(status.st_mode) || S_ISBLK(status.st_mode) || S_ISSOCK(status.st_mode))
    return Error{path.string() + ": found a device, expected a file"};
  file.regular_ = S_ISREG(status.st_mode);
  if (!file.regular_) SCANCAL_RETURN_IF_ERROR(file.AwaitWriter());
  file.size_ = file.regular_ ? status.st_size : 0;
  return file;
}

// Until there is something to read, or the writer has gone again.
Result<void> InputFile::AwaitWriter() const {
  constexpr int kPatience_ms = 10'000;
  pollfd pipe = {descriptor_, POLLIN, 0};
  int ready = ::poll(&pipe, 1, kPatience_ms);
  while (ready < 0 && errno == EINTR) ready = ::poll(&pipe, 1, kPatience_ms);
  if (ready == 0) return Error{name_ + ": found a pipe into which nobody writes, expected a file"};
  if (::fcntl(descriptor_, F_SETFL, ::fcntl(descriptor_, F_GETFL) & ~O_NONBLOCK) < 0)
    return Error{name_ + ": cannot be read: " + SystemMessage(errno)};
  return {};
}

InputFile::InputFile(InputFile&& other) noexcept { *this = std::move(other); }

InputFile& InputFile::operator=(InputFile&& other) noexcept {
  std::swap(name_, other.name_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(size_, other.size_);
  std::swap(regular_, other.regular_);
  std::swap(piped_, other.piped_);
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
    piped_ += regular_ ? 0 : std::max<int64_t>(count, 0);
    if (piped_ > kLongestPipe) return Error{name_ + ": found a pipe without an end, expected a file"};
    if (count < 0) return Error{name_ + ": cannot be read: " + SystemMessage(errno)};
    filled += static_cast<size_t>(count);
  }
  return filled;
}

Result<void> InputFile::Skip(int64_t bytes) {
  std::array<char, 65536> passed;
  while (!regular_ && bytes > 0) {
    const auto size = static_cast<size_t>(std::min<int64_t>(bytes, passed.size()));
    SCANCAL_ASSIGN_OR_RETURN(const size_t count, Read(passed.data(), size));
    if (count < size) return {};  // who reads on will see that it ended
    bytes -= static_cast<int64_t>(count);
  }
  if (!regular_) return {};
  if (::lseek(descriptor_, bytes, SEEK_CUR) < 0) return Error{name_ + ": cannot be read: " + SystemMessage(errno)};
  return {};
}

Result<std::string> ReadText(const fs::path& path, int64_t most) {
  SCANCAL_ASSIGN_OR_RETURN(InputFile file, InputFile::Open(path));
  constexpr size_t kBlock = size_t{1} << 16;
  std::string text;
  for (size_t filled = 0;;) {
    text.resize(filled + kBlock);
    SCANCAL_ASSIGN_OR_RETURN(const size_t count, file.Read(text.data() + filled, kBlock));
    filled += count;
    if (static_cast<int64_t>(filled) > most)
      return Error{path.string() + ": found more than " + std::to_string(most >> 20) + " MB, expected a small file"};
    if (count < kBlock) {
      text.resize(filled);
      return text;
    }
  }
}

Result<std::string> Sha256(const std::filesystem::path& path) {
  constexpr size_t kBlock = size_t{1} << 20;
  SCANCAL_ASSIGN_OR_RETURN(InputFile file, InputFile::Open(ArchiveOf(path)));
  const Context context = Begin();
  bool ok = context != nullptr;
  std::vector<char> buffer(kBlock);
  for (size_t count = kBlock; ok && count == kBlock;) {
    SCANCAL_ASSIGN_OR_RETURN(count, file.Read(buffer.data(), kBlock));
    ok = EVP_DigestUpdate(context.get(), buffer.data(), count) == 1;
  }
  return Finish(context, ok, file.name());
}

Result<std::string> Sha256OfText(std::string_view text) {
  const Context context = Begin();
  return Finish(context, context && EVP_DigestUpdate(context.get(), text.data(), text.size()) == 1, "text");
}

}  // namespace scancal
