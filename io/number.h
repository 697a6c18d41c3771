// Decimal numbers in text: bit for bit what std::from_chars reads, faster where a number is plain.
#pragma once
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <system_error>

namespace scancal {

// What a cell of a table holds.
enum class NumberKind {
  kNumber,
  kMissing,   // empty or nan
  kInfinite,  // inf
  kTooLarge,  // beyond the largest double: 1e999
  kText
};

struct ParsedNumber {
  NumberKind kind = NumberKind::kMissing;
  double value = 0;
};

// Any text, blanks or a pair of quotes around it are no part of it. Too small for a double (1e-400) is 0.
ParsedNumber ParseNumber(std::string_view text);

// ", expected a finite number; a missing point is nan or empty", behind what was found.
const char* Expectation(NumberKind kind);

inline std::string_view WithoutBlanks(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const size_t first = text.find_first_not_of(kBlanks);
  return first == std::string_view::npos ? std::string_view()
                                         : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

// The powers of ten that a double holds exactly.
inline constexpr double kPowersOfTen[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                          1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

// 1 / 10^k = (mantissa + something below 1) / 2^(63 + bits), for k = 1 .. 19.
struct Reciprocal {
  uint64_t mantissa = 0;
  int bits = 0;  // of 10^k
};
inline constexpr auto kReciprocals = [] {
  std::array<Reciprocal, 20> reciprocals;
  uint64_t power = 1;
  for (size_t k = 1; k < reciprocals.size(); ++k) {
    power *= 10;
    const int bits = static_cast<int>(std::bit_width(power));
    const auto numerator = static_cast<unsigned __int128>(1) << static_cast<unsigned>(63 + bits);
    reciprocals[k] = {.mantissa = static_cast<uint64_t>(numerator / power), .bits = bits};
  }
  return reciprocals;
}();

// integer / 10^decimals for an integer above 2^53 and 1 .. 19 decimals, by a product that is a little too small. Where
// that and one that is a little too large round to the same double, so does the quotient. False if they do not: once in
// some hundred numbers.
inline bool DivideLongInteger(uint64_t integer, size_t decimals, double* value) {
  const Reciprocal& reciprocal = kReciprocals[decimals];
  const int zeros = std::countl_zero(integer);
  const auto product = static_cast<unsigned __int128>(integer << static_cast<unsigned>(zeros)) * reciprocal.mantissa;
  const auto top = static_cast<int64_t>(product >> 65U);  // the quotient: between top and top + 2, times 2^exponent
  const int exponent = 2 - zeros - reciprocal.bits;
  const auto below = static_cast<double>(top), above = static_cast<double>(top + 2);
  *value = below * std::bit_cast<double>(static_cast<uint64_t>(1023 + exponent) << 52U);
  return below == above;
}

// integer / 10^decimals, if that can be had without rounding twice. Up to 2^53 an integer is exact as a double, so is
// the power of ten, and their quotient is rounded once: it is the nearest double (Clinger 1990).
inline bool ScaleInteger(uint64_t integer, std::ptrdiff_t decimals, double* value) {
  constexpr uint64_t kLargestExact = uint64_t{1} << 53U;
  constexpr std::ptrdiff_t kLargestPower = 22;
  if (integer > kLargestExact) {
    return decimals >= 1 && decimals <= 19 && DivideLongInteger(integer, static_cast<size_t>(decimals), value);
  }
  if (decimals > kLargestPower || decimals < -kLargestPower) return false;
  const auto exact = static_cast<double>(integer);
  *value = decimals >= 0 ? exact / kPowersOfTen[decimals] : exact * kPowersOfTen[-decimals];
  return true;
}

// The exponent behind 'e': [+-]digits. Returns its end, or nullptr if it is none or beyond any use here.
inline const char* ParseExponent(const char* at, std::ptrdiff_t* exponent) {
  const bool negative = *at == '-';
  if (negative || *at == '+') ++at;
  const char* const first = at;
  for (unsigned digit = 0; (digit = static_cast<unsigned>(*at) - '0') < 10 && at - first < 4; ++at) {
    *exponent = 10 * *exponent + static_cast<int>(digit);
  }
  if (negative) *exponent = -*exponent;
  return at == first || at - first > 3 ? nullptr : at;
}

// A number [-]digits[.digits][e[+-]digits] of at most 19 digits before the exponent, read as one integer and a power of
// ten. Returns the end of the number, or nullptr for any other text. The text must go on with something that is no part
// of a number.
inline const char* ParsePlainNumber(const char* text, double* value) {
  constexpr size_t kMostDigits = 19;  // fit into 64 bits
  const bool negative = *text == '-';
  const char* at = text + (negative ? 1 : 0);
  const char* const first = at;
  uint64_t integer = 0;
  const auto read_digits = [&] {
    for (unsigned digit = 0; (digit = static_cast<unsigned>(*at) - '0') < 10; ++at) integer = 10 * integer + digit;
  };
  read_digits();
  std::ptrdiff_t digits = at - first, decimals = 0;
  if (*at == '.') {
    const char* const point = at++;
    read_digits();
    decimals = at - point - 1;
    digits += decimals;
  }
  // 0 - 1 wraps around: no digits at all is refused in the same comparison as too many.
  if (static_cast<size_t>(digits) - 1 >= kMostDigits) return nullptr;
  if ((*at | 0x20) == 'e') {
    std::ptrdiff_t exponent = 0;
    at = ParseExponent(at + 1, &exponent);
    if (at == nullptr) return nullptr;
    decimals -= exponent;
  }
  double magnitude = 0;
  if (!ScaleInteger(integer, decimals, &magnitude)) return nullptr;
  *value = negative ? -magnitude : magnitude;
  return at;
}

// Reads the numbers of one column of a text. After a number that is not plain the next few go to from_chars at once:
// the value is the same either way, and a column of such numbers is not walked over twice.
class ColumnParser {
 public:
  // The finite number at the start of [text, end); returns its end, or nullptr if there is none or it wants a closer
  // look.
  const char* Parse(const char* text, const char* end, double* value) {
    if (detour_ > 0) {
      --detour_;
    } else {
      if (const char* const plain_end = ParsePlainNumber(text, value)) return plain_end;
      detour_ = kDetour;
    }
    const auto [number_end, error] = std::from_chars(text, end, *value);
    return error == std::errc() && std::isfinite(*value) ? number_end : nullptr;
  }

 private:
  static constexpr int kDetour = 15;
  int detour_ = 0;
};

}  // namespace scancal
