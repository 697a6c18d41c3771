// The header of numpy's array files (NEP 1): magic, version, a Python dictionary.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

namespace scancal {

// Always kNpyHeaderSize bytes, for an array of float64.
inline constexpr size_t kNpyHeaderSize = 128;
std::string MakeNpyHeader(int64_t rows, int64_t columns);

}  // namespace scancal
