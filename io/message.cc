#include "io/message.h"
#include <algorithm>
#include <cstdio>
#include <iterator>
#include <numeric>
#include <system_error>

namespace scancal {
namespace {

bool IsContinuation(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

// Bytes in the character that starts with `first`; 0 if none does (RFC 3629).
size_t CharacterSize(unsigned char first) {
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first < 0xE0) return 2;
  if (first >= 0xE0 && first < 0xF0) return 3;
  if (first >= 0xF0 && first < 0xF5) return 4;
  return 0;
}

// Overlong forms, surrogates and what lies beyond U+10FFFF show in the first two bytes.
bool IsForbidden(unsigned char first, unsigned char second) {
  return (first == 0xE0 && second < 0xA0) || (first == 0xED && second >= 0xA0) || (first == 0xF0 && second < 0x90) ||
         (first == 0xF4 && second >= 0x90);
}

// Levenshtein's distance, one row of the table at a time.
size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 0; i < a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i + 1;
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

// What a terminal would obey rather than show.
bool IsControl(char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }

}  // namespace

std::optional<size_t> FirstInvalidUtf8(std::string_view text) {
  for (size_t at = 0; at < text.size();) {
    const auto first = static_cast<unsigned char>(text[at]);
    const size_t size = CharacterSize(first);
    if (size == 0 || at + size > text.size()) return at;
    for (size_t i = 1; i < size; ++i) {
      if (!IsContinuation(text[at + i])) return at;
    }
    if (size > 2 && IsForbidden(first, static_cast<unsigned char>(text[at + 1]))) return at;
    at += size;
  }
  return std::nullopt;
}

size_t CountCharacters(std::string_view text) {
  return static_cast<size_t>(std::count_if(text.begin(), text.end(), [](char c) { return !IsContinuation(c); }));
}

std::string_view WithoutByteOrderMark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

TextPlace PlaceOf(std::string_view text, size_t offset) {
  const std::string_view before = text.substr(0, offset);
  const size_t line_start = before.rfind('\n') + 1;  // npos + 1 is 0
  return {.line = 1 + static_cast<size_t>(std::count(before.begin(), before.end(), '\n')),
          .column = 1 + CountCharacters(before.substr(line_start))};
}

std::string Quoted(std::string_view text) {
  constexpr size_t kLongest = 40;
  const bool cut = text.size() > kLongest;
  if (cut) {
    size_t size = kLongest;
    while (size > 0 && IsContinuation(text[size])) --size;  // never half a UTF-8 character
    text = text.substr(0, size);
  }
  std::string quoted = "\"";
  std::replace_copy_if(text.begin(), text.end(), std::back_inserter(quoted), IsControl, '?');
  return quoted + (cut ? "...\"" : "\"");
}

std::string Listed(const std::vector<std::string>& words) {
  constexpr size_t kMost = 30;
  std::string list;
  for (size_t i = 0; i < std::min(words.size(), kMost); ++i) list += (i == 0 ? "" : ", ") + words[i];
  std::replace_if(list.begin(), list.end(), IsControl, '?');
  return words.size() > kMost ? list + ", ..." : list;
}

std::string Nearest(std::string_view word, const std::vector<std::string>& candidates) {
  constexpr size_t kLongest = 60;  // longer words are no slip of the finger
  if (word.size() > kLongest) return "";
  const size_t tolerated = std::max<size_t>(1, (word.size() + 1) / 3);
  std::string nearest;
  size_t fewest = std::min(tolerated + 1, word.size());
  for (const std::string& candidate : candidates) {
    if (candidate.size() > kLongest) continue;
    const size_t distance = EditDistance(word, candidate);
    if (distance < fewest) {
      fewest = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string Suggestion(std::string_view word, const std::vector<std::string>& known) {
  const std::string nearest = Nearest(word, known);
  if (!nearest.empty()) return ", did you mean '" + nearest + "'?";
  return known.empty() ? "" : "; expected one of: " + Listed(known);
}

std::string Plainly(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", number);
  return text;
}

std::string SystemMessage(int error_number) { return std::generic_category().message(error_number); }

}  // namespace scancal
