#include "io/number.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <array>
#include <bit>
#include <cstdio>
#include <limits>
#include <random>
#include <string>

namespace scancal {
namespace {

double FromChars(const std::string& text) {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

uint64_t Bits(double value) { return std::bit_cast<uint64_t>(value); }

std::string Printed(const char* form, double value) {
  std::array<char, 512> buffer = {};
  const int size = std::snprintf(buffer.data(), buffer.size(), form, value);
  return {buffer.data(), static_cast<size_t>(size)};
}

TEST(NumberTest, PlainNumbersAreThoseOfFromCharsBitForBit) {
  constexpr uint64_t kSeed = 20240117;
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> exponent(-25, 25);
  int plain = 0, total = 0;
  for (const char* form : {"%.0f", "%.1f", "%.3f", "%.6f", "%.9f", "%.12f", "%.15f", "%.18f", "%.6g", "%.15g", "%.16g",
                           "%.17g", "%.19g", "%.25g", "%.3e", "%.7e", "%.16e", "%.18e"}) {
    for (int i = 0; i < 20000; ++i) {
      const double sign = (random() & 1U) != 0 ? 1 : -1;
      const std::string text = Printed(form, sign * std::pow(10, exponent(random)) * 0.7);
      const std::string ended = text + ",";
      double value = 0;
      ++total;
      const char* const end = ParsePlainNumber(ended.c_str(), &value);
      if (end == nullptr) continue;
      ++plain;
      ASSERT_EQ(end, ended.c_str() + text.size()) << text;
      ASSERT_EQ(Bits(value), Bits(FromChars(text))) << text << " seed " << kSeed;
    }
  }
  EXPECT_GT(plain, total / 2);
}

// (2 m + 1) / 2^k has k decimals and lies half way between two doubles: there, and one unit beside it, a product that
// is a little too small would round the wrong way.
TEST(NumberTest, LongNumbersHalfWayBetweenDoublesAreNotGuessed) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 200000; ++i) {
    uint64_t digits = 2 * ((uint64_t{1} << 52U) | (random() >> 12U)) + 1;
    const size_t decimals = 1 + random() % 4;
    for (size_t k = 0; k < decimals; ++k) digits *= 5;
    std::string text = std::to_string(digits + random() % 3 - 1);
    text.insert(text.size() - decimals, 1, '.');
    const std::string ended = text + "\n";
    double value = 0;
    if (ParsePlainNumber(ended.c_str(), &value) == nullptr) continue;
    ASSERT_EQ(Bits(value), Bits(FromChars(text))) << text;
  }
}

TEST(NumberTest, FormsAtTheEdge) {
  for (const std::string text : {"0",
                                 "-0",
                                 "0.0",
                                 ".5",
                                 "5.",
                                 "-.5",
                                 "00012.50",
                                 "9007199254740992",
                                 "9007199254740993",
                                 "9007199254740993.5",
                                 "18446744073709551615",
                                 "18446744073709551616",
                                 "1e22",
                                 "1e23",
                                 "9007199254740991e22",
                                 "9007199254740993e1",
                                 "1e-22",
                                 "1e-23",
                                 "0e999",
                                 "1e0005",
                                 "123456789012345678.9",
                                 "0.1234567890123456789",
                                 "0.00000000000000000001"}) {
    const ParsedNumber number = ParseNumber(text);
    EXPECT_EQ(number.kind, NumberKind::kNumber) << text;
    EXPECT_EQ(Bits(number.value), Bits(FromChars(text))) << text;
    double plain = 0;
    const std::string ended = text + ",";
    if (const char* const end = ParsePlainNumber(ended.c_str(), &plain)) {
      EXPECT_EQ(*end, ',') << text;
      EXPECT_EQ(Bits(plain), Bits(FromChars(text))) << text;
    }
  }
}

TEST(NumberTest, WhatIsNoNumberIsNoPlainNumber) {
  double value = 0;
  for (const char* text : {",", "-,", ".,", "-.,", "e5,", "1e,", "1e+,", "nan,", "inf,", "+1,", "x,"}) {
    EXPECT_EQ(ParsePlainNumber(text, &value), nullptr) << text;
  }
}

TEST(NumberTest, ColumnParserGivesTheSameAfterALongNumber) {
  ColumnParser parser;
  const std::string text = "0.12345678901234567890123,1.5,";
  double value = 0;
  const char* const end = text.data() + text.size();
  const char* const first = parser.Parse(text.data(), end, &value);
  EXPECT_EQ(Bits(value), Bits(FromChars("0.12345678901234567890123")));
  EXPECT_NE(parser.Parse(first + 1, end, &value), nullptr);
  EXPECT_EQ(value, 1.5);
}

TEST(NumberTest, Kinds) {
  EXPECT_EQ(ParseNumber(" 1.5 ").value, 1.5);
  EXPECT_EQ(ParseNumber("+1.5").value, 1.5);
  EXPECT_EQ(ParseNumber("\" 1.5\"").value, 1.5);
  EXPECT_EQ(ParseNumber("\u22121.5").value, -1.5);
  for (const char* text :
       {"", "  ", "\"\"", "nan", "NaN", "-NAN", "NA", "#N/A", "NULL", "--", "1.#QNAN", "-nan(ind)"}) {
    EXPECT_EQ(ParseNumber(text).kind, NumberKind::kMissing) << text;
  }
  for (const char* text : {"inf", "-Inf", "+INFINITY"}) {
    EXPECT_EQ(ParseNumber(text).kind, NumberKind::kInfinite) << text;
  }
  for (const char* text :
       {"12.3.4", "1,5", "0x10", "+-1", "--1", "1 2", "nan(1)", "1e", "-", "\"1", "1_000", "N", "\u2212-1", "---"}) {
    EXPECT_EQ(ParseNumber(text).kind, NumberKind::kText) << text;
  }
}

TEST(NumberTest, TooLargeIsTold) {
  EXPECT_EQ(ParseNumber("1e999").kind, NumberKind::kTooLarge);
  EXPECT_EQ(ParseNumber("-1e309").kind, NumberKind::kTooLarge);
  EXPECT_EQ(ParseNumber(std::string(400, '9')).kind, NumberKind::kTooLarge);
}

TEST(NumberTest, TooSmallIsZeroOrDenormal) {
  const ParsedNumber denormal = ParseNumber("1e-320"), zero = ParseNumber("1e-400");
  EXPECT_EQ(denormal.kind, NumberKind::kNumber);
  EXPECT_EQ(denormal.value, 1e-320);
  EXPECT_EQ(zero.kind, NumberKind::kNumber);
  EXPECT_EQ(zero.value, 0);
}

}  // namespace
}  // namespace scancal
