// Text encoding: everything inside is UTF-8.
#pragma once
#include <cstddef>
#include <optional>
#include <string_view>

namespace scancal {

std::optional<size_t> FirstInvalidUtf8(std::string_view text);  // offset of the first byte that is not UTF-8
size_t CountCharacters(std::string_view text);                  // of UTF-8 text
std::string_view WithoutByteOrderMark(std::string_view text);

struct TextPlace {
  size_t line = 1, column = 1;  // 1-based; the column counts characters
};
TextPlace PlaceOf(std::string_view text, size_t offset);

}  // namespace scancal
