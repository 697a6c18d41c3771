// The header of numpy's array files (NEP 1): magic, version, a Python dictionary.
#pragma once
#include <cstdint>
#include <string>
#include "io/input_file.h"
#include "io/result.h"

namespace scancal {

struct NpyHeader {
  std::string type;  // '<f8', '<f4'
  bool fortran_order = false;
  int64_t rows = 0, columns = 0;
  int64_t bytes = 0;  // of the header itself
};

// From the start of the file; leaves it at the first number. Anything but a two-dimensional array of float64 or float32
// in C order: an error.
Result<NpyHeader> ReadNpyHeader(InputFile& file);

// Always kNpyHeaderSize bytes, for an array of float64.
inline constexpr size_t kNpyHeaderSize = 128;
std::string MakeNpyHeader(int64_t rows, int64_t columns);

}  // namespace scancal
