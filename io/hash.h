// Which bytes a result was computed from.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include "io/result.h"

namespace scancal {

// 64 lower-case hexadecimal digits.
Result<std::string> Sha256(const std::filesystem::path& path);
Result<std::string> Sha256OfText(std::string_view text);

}  // namespace scancal
