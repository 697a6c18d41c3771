#include "io/message.h"
#include <algorithm>
#include <iterator>
#include <numeric>
#include <system_error>

namespace scancal {
namespace {

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

bool IsContinuation(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

// What a terminal would obey rather than show.
bool IsControl(char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }

}  // namespace

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

std::string SystemMessage(int error_number) { return std::generic_category().message(error_number); }

}  // namespace scancal
