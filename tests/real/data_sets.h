// Data sets that are no part of the project.
#pragma once
#include <cstdlib>
#include <filesystem>

namespace scancal {

// The folder that holds them, tilting-lidar/ and the others; there or not.
inline std::filesystem::path DataSets() {
  const char* const named = std::getenv("SCANCAL_DATASETS");
  return named ? std::filesystem::path(named)
               : std::filesystem::path(SCANCAL_SOURCE_DIR) / ".." / "shared" / "datasets";
}

}  // namespace scancal
