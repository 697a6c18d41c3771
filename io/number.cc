#include "io/number.h"
#include <locale.h>
#include <algorithm>
#include <cstdlib>
#include <string>

namespace scancal {
namespace {

bool EqualsIgnoringCase(std::string_view text, std::string_view lower_case) {
  return std::equal(text.begin(), text.end(), lower_case.begin(), lower_case.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b; });
}

// from_chars does not say which way a number is out of range; strtod does, whatever the locale of the program.
ParsedNumber ParseOutOfRange(std::string_view text) {
  static const locale_t plain = ::newlocale(LC_ALL_MASK, "C", nullptr);
  const double value = ::strtod_l(std::string(text).c_str(), nullptr, plain);
  return {std::isfinite(value) ? NumberKind::kNumber : NumberKind::kTooLarge, value};
}

std::string_view WithoutQuotes(std::string_view text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') return text.substr(1, text.size() - 2);
  return text;
}

// What spreadsheets, databases and the C libraries of others write where there is no number.
bool IsMissingText(std::string_view text, std::string_view magnitude) {
  for (const char* missing : {"#n/a", "n/a", "na", "null", "none", "--"})
    if (EqualsIgnoringCase(text, missing)) return true;
  for (const char* nan : {"nan", "nan(ind)", "nan(snan)", "1.#qnan", "1.#snan", "1.#ind", "1.#nan"})
    if (EqualsIgnoringCase(magnitude, nan)) return true;
  return false;
}

}  // namespace

ParsedNumber ParseNumber(std::string_view text) {
  text = WithoutBlanks(WithoutQuotes(WithoutBlanks(text)));
  constexpr std::string_view kMinus = "\u2212";
  if (text.starts_with(kMinus)) {
    const ParsedNumber magnitude = ParseNumber(text.substr(kMinus.size()));
    const bool number = magnitude.kind == NumberKind::kNumber && text.substr(kMinus.size()).find_first_of("+-") != 0;
    return {number ? magnitude.kind : NumberKind::kText, -magnitude.value};
  }
  if (text.empty()) return {NumberKind::kMissing, 0};
  if (text.front() == '+') {  // from_chars knows no plus
    text.remove_prefix(1);
    if (text.starts_with('-')) return {NumberKind::kText, 0};
  }
  const std::string_view magnitude = text.starts_with('-') ? text.substr(1) : text;
  if (IsMissingText(text, magnitude)) return {NumberKind::kMissing, 0};
  if (EqualsIgnoringCase(magnitude, "inf") || EqualsIgnoringCase(magnitude, "infinity") ||
      EqualsIgnoringCase(magnitude, "1.#inf")) {
    return {NumberKind::kInfinite, 0};
  }
  double value = 0;
  const char* const text_end = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), text_end, value);
  if (end != text_end || error == std::errc::invalid_argument || std::isnan(value)) return {NumberKind::kText, 0};
  if (error == std::errc::result_out_of_range) return ParseOutOfRange(text);
  return {NumberKind::kNumber, value};
}

const char* Expectation(NumberKind kind) {
  return kind == NumberKind::kInfinite   ? ", expected a finite number; a missing point is nan or empty"
         : kind == NumberKind::kTooLarge ? ", expected a number within +-1.8e308"
                                         : ", expected a number";
}

}  // namespace scancal
