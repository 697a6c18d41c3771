// A file that is there whole or not at all.
#pragma once
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include "io/result.h"

namespace scancal {

// Written under a temporary name beside its own, renamed by Commit(). Without Commit() (an error, Ctrl-C, SIGTERM)
// nothing stays behind and an older file of that name keeps its contents. Buffered; a full disk is told by Write or
// Commit.
class OutputFile {
 public:
  static Result<OutputFile> Create(const std::filesystem::path& path);  // makes missing folders
  OutputFile(OutputFile&&) noexcept;
  OutputFile& operator=(OutputFile&&) noexcept;
  ~OutputFile();
  Result<void> Write(std::string_view bytes);
  Result<void> Rewrite(int64_t offset,
                       std::string_view bytes);  // over bytes already written: a header that needs the count
  Result<void> Commit();

 private:
  struct Impl;
  explicit OutputFile(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

Result<void> WriteFile(const std::filesystem::path& path, std::string_view bytes);  // Create, Write, Commit

template <class Number>
void AppendBytes(std::string* bytes, Number value) {  // little endian, like the machine
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes->append(raw, sizeof value);
}

template <class Number>
void AppendText(std::string* text, Number value) {  // as many digits as bring the same number back
  char digits[32];
  const auto [end, error] = std::to_chars(std::begin(digits), std::end(digits), value);
  text->append(digits, end);
}

}  // namespace scancal
