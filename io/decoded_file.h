// A text file as it is meant: unpacked, and in UTF-8.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include "io/input_file.h"
#include "io/result.h"

namespace scancal {

// What a file is packed in (.gz, .zst, .zip) and whether it is UTF-16 is told from its first bytes, whatever its name.
// A .zip holds one file; of several the path names one, "scans.zip/left.csv". Streaming: memory does not grow with what
// is unpacked, and what grows by more than 500 times is refused. Windows-1252 comes through as it is: it differs from
// UTF-8 in names only.
class DecodedFile {
 public:
  static Result<DecodedFile> Open(const std::filesystem::path& path);
  DecodedFile(DecodedFile&&) noexcept;
  DecodedFile& operator=(DecodedFile&&) noexcept;
  ~DecodedFile();

  Result<size_t> Read(char* buffer, size_t size);  // fills the buffer; fewer bytes only at the end
  Result<void> Skip(int64_t bytes);
  // The first bytes, at most 512, before any is read.
  std::string_view start() const;
  bool sized() const;  // size() is that of what is read: a regular file, not packed
  const std::string& name() const;
  int64_t size() const;                 // of the file, bytes
  int64_t bytes_read() const;           // of the file, so far
  const std::string& wrapping() const;  // "gzip", "UTF-16", "zip, UTF-16"; empty: plain

 private:
  struct Impl;
  explicit DecodedFile(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// The archive in which a path lies, "scans.zip" of "scans.zip/left.csv"; else the path itself.
std::filesystem::path ArchiveOf(const std::filesystem::path& path);

}  // namespace scancal
