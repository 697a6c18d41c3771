#include <gtest/gtest.h>
#include <cmath>
#include <limits>
#include "report/text.h"

namespace scancal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();

TEST(ConciseTest, UStandsInUnitsOfTheLastDigit) {
  EXPECT_EQ(Concise(123.00214, 0.0054), "123.0021(54)");
  EXPECT_EQ(Concise(408.884642, 0.13164), "408.88(13)");
  EXPECT_EQ(Concise(100.02147, 0.00035), "100.02147(35)");  // GUM 7.2.2
}

TEST(ConciseTest, RoundingMayShiftTheLastDigit) {
  EXPECT_EQ(Concise(1.23456, 0.0996), "1.23(10)");
  EXPECT_EQ(Concise(1.23456, 0.0994), "1.235(99)");
  EXPECT_EQ(Concise(123.456, 0.996), "123.5(10)");
  EXPECT_EQ(Concise(1234.56, 9.96), "1235(10)");
}

TEST(ConciseTest, PowersOfTen) {
  EXPECT_EQ(Concise(5, 0.1), "5.00(10)");
  EXPECT_EQ(Concise(5, 0.01), "5.000(10)");
  EXPECT_EQ(Concise(5, 0.001), "5.0000(10)");
  EXPECT_EQ(Concise(5, 1), "5.0(10)");
}

TEST(ConciseTest, ULargerThanOneToo) {
  EXPECT_EQ(Concise(123.93, 3.9), "123.9(39)");
  EXPECT_EQ(Concise(123.93, 39), "124(39)");
}

TEST(ConciseTest, FromAHundredOnUStandsWhole) {
  EXPECT_EQ(Concise(1234.56, 99.6), "1235(100)");
  EXPECT_EQ(Concise(181.3, 1477.4), "181(1477)");
  EXPECT_EQ(Concise(12345.6, 123.4), "12346(123)");
}

TEST(ConciseTest, NegativeValues) {
  EXPECT_EQ(Concise(-0.00012346, 0.0000012), "-0.0001235(12)");
  EXPECT_EQ(Concise(-57.25, 0.031), "-57.250(31)");
}

TEST(ConciseTest, ZeroHasNoSign) { EXPECT_EQ(Concise(-1e-12, 0.01), "0.000(10)"); }

TEST(ConciseTest, WithoutAUsefulUSixDigits) {
  for (const double u : {0.0, -1.0, kInfinity, kNan}) EXPECT_EQ(Concise(123.456789, u), "123.457") << u;
  EXPECT_EQ(Concise(0, 0), "0.00000");
}

TEST(ConciseTest, ValuesThatAreNone) {
  EXPECT_EQ(Concise(kNan, 0.1), "-");
  EXPECT_EQ(Concise(kInfinity, 0.1), "infinite");
  EXPECT_EQ(Concise(kNan, 0), "-");
}

TEST(SignificantTest, DigitsCountFromTheFirstOne) {
  EXPECT_EQ(Significant(0.050705, 4), "0.05071");
  EXPECT_EQ(Significant(1.98197, 3), "1.98");
  EXPECT_EQ(Significant(-0.354321, 3), "-0.354");
  EXPECT_EQ(Significant(0, 3), "0.00");
  EXPECT_EQ(Significant(1, 2), "1.0");
}

TEST(SignificantTest, RoundingUpAddsNoDigit) {
  EXPECT_EQ(Significant(0.0999, 2), "0.10");
  EXPECT_EQ(Significant(9.996, 3), "10.0");
  EXPECT_EQ(Significant(99.96, 3), "100");
}

TEST(SignificantTest, NoExponentsInBetween) {
  EXPECT_EQ(Significant(999999, 3), "999999");
  EXPECT_EQ(Significant(12345.6, 3), "12346");
  EXPECT_EQ(Significant(0.0001, 2), "0.00010");
}

TEST(SignificantTest, ExponentsBeyond) {
  EXPECT_EQ(Significant(1e6, 3), "1.00e+06");
  EXPECT_EQ(Significant(2.311e-12, 4), "2.311e-12");
  EXPECT_EQ(Significant(-9.9e-5, 2), "-9.9e-05");
}

TEST(SignificantTest, WhatIsNoNumber) {
  EXPECT_EQ(Significant(kNan, 3), "-");
  EXPECT_EQ(Significant(kInfinity, 3), "infinite");
  EXPECT_EQ(Significant(-kInfinity, 3), "-infinite");
}

TEST(CountTest, WholeWithoutExponent) {
  EXPECT_EQ(Count(0), "0");
  EXPECT_EQ(Count(6005001), "6005001");
  EXPECT_EQ(Count(1e15), "1000000000000000");
  EXPECT_EQ(Count(kInfinity), "infinite");
}

TEST(TextTableTest, TheFirstColumnToTheLeftTheOthersToTheRight) {
  TextTable table({"", "value", "u"});
  table.Add({"M", "123.0", "0.1"});
  table.Add({"tilt_x", "5", ""});
  EXPECT_EQ(table.Text(),
            "        value    u\n"
            "------------------\n"
            "M       123.0  0.1\n"
            "tilt_x      5\n");
}

TEST(TextTableTest, CharactersCountNotBytes) {
  TextTable table({"method", "ΔM/u", "step/√12"});
  table.Add({"größer", "1.5", "2"});
  table.Add({"plain", "10.25", "-"});
  EXPECT_EQ(table.Text(),
            "method   ΔM/u  step/√12\n"
            "-----------------------\n"
            "größer    1.5         2\n"
            "plain   10.25         -\n");
}

TEST(WrappedTest, SentencesBreakAtBlanksTablesNever) {
  EXPECT_EQ(Wrapped("warning: µ one two three\n", 12), "warning: µ\n  one two\n  three\n");
  EXPECT_EQ(Wrapped("averyveryverylongword at last\n", 8), "averyveryverylongword\n  at\n  last\n");
  const std::string as_it_is = "short\n\na  1234567890123\n----------------\n";
  EXPECT_EQ(Wrapped(as_it_is, 8), as_it_is);
}

TEST(TextTableTest, AHeaderAlone) { EXPECT_EQ(TextTable({"a", "bc"}).Text(), "a  bc\n-----\n"); }

}  // namespace
}  // namespace scancal
