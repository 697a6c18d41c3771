// Which bytes a result was computed from.
#pragma once
#include <filesystem>
#include <string>
#include "io/result.h"

namespace scancal {

Result<std::string> Sha256(const std::filesystem::path& path);  // 64 lower-case hexadecimal digits

}  // namespace scancal
