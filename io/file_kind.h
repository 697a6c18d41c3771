// The layouts of files that instruments write, told by their first bytes or named by `format:`.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>
#include "io/result.h"
#include "io/scan.h"

namespace scancal {

struct FileKind {
  const char* name;   // in `format:`
  const char* title;  // for messages
  // start: the first bytes of the file, unpacked, at most 256 KB.
  bool (*is_it)(std::string_view start, const ScanFormat& format);
  Result<std::unique_ptr<ScanReader>> (*open)(const ScanFormat& format);
};

extern const FileKind kGocator, kLjV, kLjX, kHeightImage, kPly, kPcd;

// As `format:` names it, or as its content says; nullptr: none of them, a text or .npy with a column for each quantity.
const FileKind* FindFileKind(const ScanFormat& format);

const FileKind* NamedFileKind(std::string_view name);  // nullptr: there is none
std::vector<std::string> FileKindNames();
std::string TriedFileKinds();  // "; tried too: Gocator CSV, ..."

Result<std::string> FirstBytes(const std::filesystem::path& path, size_t most);  // unpacked

bool StartsAsImage(std::string_view start);  // .png or .npy

// Of the first bytes; empty at their end.
std::string_view TakeFirstLine(std::string_view* text);

}  // namespace scancal
