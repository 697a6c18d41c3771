// JSON documents on disk.
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include "io/result.h"

namespace scancal {

// Keys keep the order in which they were put in.
using Json = nlohmann::ordered_json;
Result<Json> ReadJson(const std::filesystem::path& path);  // up to 1 GiB; errors with file:line:column
Result<void> WriteJson(const std::filesystem::path& path,
                       const Json& json);  // through OutputFile, two spaces, lists of values on one line, final newline

}  // namespace scancal
