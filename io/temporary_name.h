// Temporary files that do not outlive the program, not even when it is stopped by Ctrl-C.
#pragma once
#include <filesystem>
#include <string>
#include "io/result.h"

namespace scancal {

// A name for a temporary file in a folder. While it lives, SIGINT, SIGTERM and SIGHUP remove the file before they end
// the program, unless the program handles or ignores them itself.
class TemporaryName {
 public:
  static Result<TemporaryName> In(const std::filesystem::path& folder);
  TemporaryName(TemporaryName&& other) noexcept;
  TemporaryName& operator=(TemporaryName&& other) noexcept;
  ~TemporaryName();  // does not remove the file
  const std::string& path() const { return path_; }

 private:
  TemporaryName(std::string path, int slot) : path_(std::move(path)), slot_(slot) {}
  std::string path_;
  int slot_ = -1;
};

}  // namespace scancal
