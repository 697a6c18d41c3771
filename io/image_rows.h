// The rows of an image of heights, whatever file holds it.
#pragma once
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>
#include "io/result.h"

namespace scancal {

// Row by row, as its numbers stand there.
class ImageRows {
 public:
  virtual ~ImageRows() = default;
  virtual Result<void> Read(std::vector<double>* row) = 0;  // the next one
  virtual int64_t bytes_read() const = 0;
  virtual int64_t bytes_total() const = 0;
  std::string title;
  bool whole = true;  // numbers: they count something
  int64_t height = 0, width = 0;
};

template <class Number>
void AppendNumbers(std::string_view bytes, std::vector<double>* row) {
  for (size_t at = 0; at + sizeof(Number) <= bytes.size(); at += sizeof(Number)) {
    Number number = 0;
    std::memcpy(&number, bytes.data() + at, sizeof number);
    row->push_back(static_cast<double>(number));
  }
}

// 16 bits, whole numbers, or 32 bits, floating point; grey, one image, in strips. Whatever else a TIFF can be is
// refused, as is one where the program was built without libtiff.
bool StartsAsTiff(std::string_view start);
Result<std::unique_ptr<ImageRows>> OpenTiff(const std::filesystem::path& path);

}  // namespace scancal
