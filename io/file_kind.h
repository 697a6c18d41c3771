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

extern const FileKind kGocator, kLjV, kLjX, kHeightImage, kPly, kPcd, kRos1, kRos2;

// As its content says, or where that does not tell as `format:` names it; nullptr: none of them, a text or .npy with a
// column for each quantity. An error where the content is of another kind than `format:` names.
Result<const FileKind*> FindFileKind(const ScanFormat& format);

const FileKind* NamedFileKind(std::string_view name);  // nullptr: there is none
std::vector<std::string> FileKindNames();
std::string OptionalFileKinds();  // those that this program was built with: "ROS 2 bags, TIFF"; or empty
std::string TriedFileKinds();     // "; tried too: Gocator CSV, ..."

bool IsReadOnce(const std::filesystem::path& path);  // a pipe
// Unpacked; of a pipe, which cannot be begun again, an error.
Result<std::string> FirstBytes(const std::filesystem::path& path, size_t most);

bool StartsAsImage(std::string_view start);  // .png, .tif or .npy

// Of the first bytes; empty at their end.
std::string_view TakeFirstLine(std::string_view* text);

}  // namespace scancal
