// JSON documents on disk, and bytes inside them.
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include "io/json.h"
#include "io/result.h"

namespace scancal {

Result<Json> ReadJson(const std::filesystem::path& path);  // up to 1 GiB; errors with file:line:column
// Through OutputFile, two spaces, lists of values on one line, final newline.
Result<void> WriteJson(const std::filesystem::path& path, const Json& json);

// Bytes as text (RFC 4648, section 4): padded, without blanks or line ends; up to 1 GiB.
std::string ToBase64(std::string_view bytes);
Result<std::string> FromBase64(std::string_view text);  // says at which character the text is none

}  // namespace scancal
