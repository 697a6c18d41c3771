// An open file to read from, with complaints that name it, and the fingerprint of its bytes.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include "io/result.h"

namespace scancal {

class InputFile {
 public:
  // Missing, a directory, a device, not readable: errors. A pipe will do if somebody writes into it.
  static Result<InputFile> Open(const std::filesystem::path& path);
  InputFile(InputFile&& other) noexcept;
  InputFile& operator=(InputFile&& other) noexcept;
  ~InputFile();

  // Fills the buffer; fewer bytes only at the end of the file.
  Result<size_t> Read(char* buffer, size_t size);
  Result<void> Skip(int64_t bytes);
  const std::string& name() const { return name_; }  // as the caller gave it
  int64_t size() const { return size_; }             // bytes; 0 for a pipe
  bool regular() const { return regular_; }

 private:
  InputFile(std::string name, int descriptor) : name_(std::move(name)), descriptor_(descriptor) {}
  Result<void> AwaitWriter() const;
  std::string name_;
  int descriptor_ = -1;
  int64_t size_ = 0;
  bool regular_ = false;
  int64_t piped_ = 0;  // bytes, of a pipe
};

// The whole file, of at most so many bytes.
Result<std::string> ReadText(const std::filesystem::path& path, int64_t most = int64_t{1} << 30);

// 64 lower-case hexadecimal digits.
Result<std::string> Sha256(const std::filesystem::path& path);
Result<std::string> Sha256OfText(std::string_view text);

}  // namespace scancal
