#include "io/temporary_name.h"
#include <unistd.h>
#include <array>
#include <atomic>
#include <climits>
#include <csignal>
#include <cstring>
#include <utility>

namespace scancal {
namespace {

// A signal handler may touch little more than this: plain memory, lock-free atomics, unlink.
struct Slot {
  std::atomic<bool> taken = false;
  std::atomic<pid_t> owner = 0;  // 0: the path is not valid; a forked child must not remove its parent's files
  char path[PATH_MAX] = {};
};
constexpr int kSlots = 32;
std::array<Slot, kSlots> slots;
static_assert(std::atomic<pid_t>::is_always_lock_free);

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

void RemoveFilesAndRaise(int signal) {
  const pid_t self = ::getpid();
  for (const Slot& slot : slots) {
    if (slot.owner == self) ::unlink(slot.path);
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

int TakeSlot(const std::string& path) {
  for (int i = 0; i < kSlots; ++i) {
    Slot& slot = slots[static_cast<size_t>(i)];
    if (slot.taken.exchange(true)) continue;
    std::memcpy(slot.path, path.c_str(), path.size() + 1);
    slot.owner = ::getpid();
    return i;
  }
  return -1;
}

}  // namespace

Result<TemporaryName> TemporaryName::In(const std::filesystem::path& folder) {
  static std::atomic<int> count = 0;
  std::error_code error;
  const std::string name = ".scancal-" + std::to_string(::getpid()) + "-" + std::to_string(++count) + ".tmp";
  // Absolute: the program may change its folder meanwhile.
  std::string path = (std::filesystem::absolute(folder, error) / name).string();
  if (path.size() >= PATH_MAX) return Error{folder.string() + ": the path is too long"};
  InstallHandlers();
  const int slot = TakeSlot(path);
  if (slot < 0) return Error{folder.string() + ": more than " + std::to_string(kSlots) + " files written at a time"};
  return TemporaryName(std::move(path), slot);
}

TemporaryName::TemporaryName(TemporaryName&& other) noexcept { *this = std::move(other); }

TemporaryName& TemporaryName::operator=(TemporaryName&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(slot_, other.slot_);
  return *this;
}

TemporaryName::~TemporaryName() {
  if (slot_ < 0) return;
  Slot& slot = slots[static_cast<size_t>(slot_)];
  slot.owner = 0;
  slot.taken = false;
}

}  // namespace scancal
