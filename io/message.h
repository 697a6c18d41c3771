// The words that error messages are made of, and places in a text. Everything inside is UTF-8.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scancal {

// What was found, for a message: in quotes, cut when long, control characters shown as "?".
std::string Quoted(std::string_view text);

std::string Listed(const std::vector<std::string>& words);  // a, b, c; the first thirty

// The candidate with the fewest edits (insert, delete, replace a character), or empty if none is close enough to have
// been meant.
std::string Nearest(std::string_view word, const std::vector<std::string>& candidates);

// ", did you mean 'search'?", or "; expected one of: a, b, c" if none is near; empty if nothing is known.
std::string Suggestion(std::string_view word, const std::vector<std::string>& known);

std::string Plainly(double number);  // nine digits, without trailing zeros: 0.05

std::string SystemMessage(int error_number);  // No such file or directory

std::optional<size_t> FirstInvalidUtf8(std::string_view text);  // offset of the first byte that is not UTF-8
size_t CountCharacters(std::string_view text);                  // of UTF-8 text
std::string_view WithoutByteOrderMark(std::string_view text);

struct TextPlace {
  size_t line = 1, column = 1;  // 1-based; the column counts characters
};
TextPlace PlaceOf(std::string_view text, size_t offset);

}  // namespace scancal
