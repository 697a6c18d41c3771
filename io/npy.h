// The header of numpy's array files (NEP 1): magic, version, a Python dictionary.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include "io/decoded_file.h"
#include "io/result.h"

namespace scancal {

inline constexpr std::string_view kNpyStart = "\x93NUMPY";

struct NpyHeader {
  std::string type;  // '<f8', '<f4'; of an image also '<u2', '<i2', '<i4'
  int64_t rows = 0, columns = 0;
  int64_t bytes = 0;  // of the header itself
  int64_t row_bytes() const { return columns * (type.back() - '0'); }
};

// From the start of the file; leaves it at the first number. Anything but a two-dimensional array in C order is an
// error; image: of whole numbers, too.
Result<NpyHeader> ReadNpyHeader(DecodedFile* file, bool image = false);
// That the file has as many bytes as its header says; of a pipe, or packed, only that so many are possible.
Result<void> CheckNpySize(const NpyHeader& header, const DecodedFile& file);

// Always kNpyHeaderSize bytes, for an array of float64.
inline constexpr size_t kNpyHeaderSize = 128;
std::string MakeNpyHeader(int64_t rows, int64_t columns);

}  // namespace scancal
