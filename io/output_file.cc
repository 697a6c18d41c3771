#include "io/output_file.h"
#include <fcntl.h>
#include <unistd.h>
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstring>
#include <string>
#include <utility>
#include "io/message.h"

namespace scancal {
namespace {

namespace fs = std::filesystem;

// A signal handler may touch little more than this: plain memory, lock-free atomics, unlink.
struct Slot {
  std::atomic<bool> taken = false;
  std::atomic<pid_t> owner = 0;  // 0: the path is not valid; a forked child must not remove its parent's files
  char path[PATH_MAX] = {};
  char target[PATH_MAX] = {};  // as the caller named it
};
constexpr int kSlots = 32;
std::array<Slot, kSlots> slots;
static_assert(std::atomic<pid_t>::is_always_lock_free);

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

void Tell(const char* text) {
  [[maybe_unused]] const ssize_t ignored = ::write(STDERR_FILENO, text, std::strlen(text));
}

void RemoveFilesAndRaise(int signal) {
  const pid_t self = ::getpid();
  for (const Slot& slot : slots) {
    if (slot.owner != self) continue;
    ::unlink(slot.path);
    for (const char* part : {"\nscancal: interrupted: ", slot.target, " was not written\n"}) Tell(part);
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);  // delivered as soon as this handler returns
}

void InstallHandlers() {
  for (const int signal : kSignals) {
    struct sigaction action = {};
    const bool unhandled = ::sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_DFL;
    if (!unhandled) continue;  // nohup, or a program with its own way to stop
    action.sa_handler = RemoveFilesAndRaise;
    ::sigemptyset(&action.sa_mask);
    ::sigaction(signal, &action, nullptr);
  }
}

int TakeSlot(const std::string& path, const std::string& target) {
  for (int i = 0; i < kSlots; ++i) {
    Slot& slot = slots[static_cast<size_t>(i)];
    if (slot.taken.exchange(true)) continue;
    std::memcpy(slot.path, path.c_str(), path.size() + 1);
    std::strncpy(slot.target, target.c_str(), sizeof slot.target - 1);
    slot.owner = ::getpid();
    return i;
  }
  return -1;
}

// A name for a temporary file in a folder. While it lives, SIGINT, SIGTERM and SIGHUP remove the file and say that its
// target was not written before they end the program, unless the program handles or ignores them itself.
class TemporaryName {
 public:
  static Result<TemporaryName> In(const fs::path& folder, const fs::path& target);
  TemporaryName(TemporaryName&& other) noexcept { *this = std::move(other); }
  TemporaryName& operator=(TemporaryName&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(slot_, other.slot_);
    return *this;
  }
  ~TemporaryName();  // does not remove the file
  const std::string& path() const { return path_; }

 private:
  TemporaryName(std::string path, int slot) : path_(std::move(path)), slot_(slot) {}
  std::string path_;
  int slot_ = -1;
};

Result<TemporaryName> TemporaryName::In(const fs::path& folder, const fs::path& target) {
  static std::atomic<int> count = 0;
  std::error_code error;
  const std::string name = ".scancal-" + std::to_string(::getpid()) + "-" + std::to_string(++count) + ".tmp";
  // Absolute: the program may change its folder meanwhile.
  std::string path = (fs::absolute(folder, error) / name).string();
  if (path.size() >= PATH_MAX) return Error{folder.string() + ": the path is too long"};
  InstallHandlers();
  const int slot = TakeSlot(path, target.string());
  if (slot < 0) return Error{folder.string() + ": more than " + std::to_string(kSlots) + " files written at a time"};
  return TemporaryName(std::move(path), slot);
}

TemporaryName::~TemporaryName() {
  if (slot_ < 0) return;
  Slot& slot = slots[static_cast<size_t>(slot_)];
  slot.owner = 0;
  slot.taken = false;
}

Error CannotWrite(const fs::path& path, const std::string& reason) {
  return Error{path.string() + ": cannot be written: " + reason};
}

// The folder for `path`, made if it is missing.
Result<fs::path> MakeFolder(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code error;
  for (fs::path part = folder; !part.empty(); part = part.parent_path()) {
    if (fs::exists(part, error) && !fs::is_directory(part, error)) {
      return CannotWrite(path, part.string() + " is a file, expected a folder");
    }
    if (part == part.parent_path()) break;
  }
  fs::create_directories(folder, error);
  if (error) return CannotWrite(path, "the folder cannot be made: " + error.message());
  return folder;
}

// Renaming over a folder fails late, over a device it succeeds and ruins the system.
Result<void> CheckTarget(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!path.has_filename() || fs::is_directory(status)) return CannotWrite(path, "found a folder, expected a file");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    return CannotWrite(path, "found a device or a pipe, expected a file");
  }
  return {};
}

// Behind a symbolic link the file is replaced, not the link.
fs::path BehindLink(const fs::path& path) {
  std::error_code error;
  if (!fs::is_symlink(path, error)) return path;
  const fs::path target = fs::weakly_canonical(path, error);
  return error ? path : target;
}

}  // namespace

struct OutputFile::Impl {
  Impl(fs::path given, fs::path path, TemporaryName temporary)
      : given(std::move(given)), path(std::move(path)), temporary(std::move(temporary)) {}
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    if (descriptor < 0) return;
    ::close(descriptor);
    ::unlink(temporary.path().c_str());
  }

  Result<void> Fail(int error_number) {
    if (!error) error = CannotWrite(given, SystemMessage(error_number));
    return *error;
  }

  Result<void> WriteAt(int64_t offset, std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::pwrite(descriptor, bytes.data(), bytes.size(), offset);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) return Fail(errno);
      bytes.remove_prefix(static_cast<size_t>(count));
      offset += count;
    }
    return {};
  }

  Result<void> Flush() {
    if (error) return *error;
    SCANCAL_RETURN_IF_ERROR(WriteAt(written, buffer));
    written += static_cast<int64_t>(buffer.size());
    buffer.clear();
    return {};
  }

  fs::path given;  // as the caller named it
  fs::path path;
  TemporaryName temporary;
  int descriptor = -1;
  std::string buffer;
  int64_t written = 0;         // bytes, without the buffer
  std::optional<Error> error;  // the first one; everything after it fails alike
};

Result<OutputFile> OutputFile::Create(const fs::path& path) {
  SCANCAL_RETURN_IF_ERROR(CheckTarget(path));
  const fs::path target = BehindLink(path);
  SCANCAL_ASSIGN_OR_RETURN(const fs::path folder, MakeFolder(target));
  SCANCAL_ASSIGN_OR_RETURN(TemporaryName temporary, TemporaryName::In(folder, path));
  auto impl = std::make_unique<Impl>(path, target, std::move(temporary));
  // A file of this name can only be left from a killed program that had our number.
  impl->descriptor =
      ::open(impl->temporary.path().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (impl->descriptor < 0) return impl->Fail(errno).error();
  return OutputFile(std::move(impl));
}

OutputFile::OutputFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
OutputFile::OutputFile(OutputFile&&) noexcept = default;
OutputFile& OutputFile::operator=(OutputFile&&) noexcept = default;
OutputFile::~OutputFile() = default;

Result<void> OutputFile::Write(std::string_view bytes) {
  constexpr size_t kBuffer = size_t{1} << 18;
  if (impl_->error) return *impl_->error;
  impl_->buffer.append(bytes);
  return impl_->buffer.size() < kBuffer ? Result<void>() : impl_->Flush();
}

Result<void> OutputFile::Rewrite(int64_t offset, std::string_view bytes) {
  SCANCAL_RETURN_IF_ERROR(impl_->Flush());
  if (offset < 0 || offset + static_cast<int64_t>(bytes.size()) > impl_->written) return impl_->Fail(EINVAL);
  return impl_->WriteAt(offset, bytes);
}

Result<void> OutputFile::Commit() {
  SCANCAL_RETURN_IF_ERROR(impl_->Flush());
  const std::string& temporary = impl_->temporary.path();
  // On the disk before it has the name: a power failure leaves the old file or the new one.
  if (::fsync(impl_->descriptor) != 0 && errno != EINVAL) return impl_->Fail(errno);
  if (::rename(temporary.c_str(), impl_->path.c_str()) != 0) return impl_->Fail(errno);
  ::close(impl_->descriptor);
  impl_->descriptor = -1;
  impl_->error = CannotWrite(impl_->given, "it is finished already");  // for whoever goes on writing
  return {};
}

Result<void> WriteFile(const fs::path& path, std::string_view bytes) {
  SCANCAL_ASSIGN_OR_RETURN(OutputFile file, OutputFile::Create(path));
  SCANCAL_RETURN_IF_ERROR(file.Write(bytes));
  return file.Commit();
}

}  // namespace scancal
