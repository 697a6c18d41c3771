#include "models/selftest/selftest.h"
#include <gmock/gmock.h>
#include <cmath>
#include "tests/io/temporary_folder.h"

namespace scancal::selftest {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(SelftestOwnCases, Pass) {
  const std::vector<SelftestRow> rows = OwnCases();
  EXPECT_EQ(rows.size(), 7u);
  for (const SelftestRow& row : rows) {
    EXPECT_TRUE(row.pass()) << row.name << ": " << row.values.reached << " digits, " << row.deviations.reached
                            << " of u";
    EXPECT_THAT(row.note, IsEmpty()) << row.name;
  }
}

// Another digit in the given place, counted from the first that is not zero.
std::string Changed(std::string number, int place) {
  size_t at = number.find_first_of("123456789");
  for (int k = 1; k < place; ++k) at = number.find_first_of("0123456789", at + 1);
  number[at] = number[at] == '5' ? '6' : '5';
  return number;
}

TEST(SelftestOwnCases, OneWrongDigitOfAnyReferenceFails) {
  for (const ExactShape& shape : ExactShapes()) {
    for (size_t k = 0; k < shape.values.size(); ++k) {
      ExactShape wrong = shape;
      wrong.values[k] = Changed(shape.values[k], 10);
      EXPECT_FALSE(Check(wrong).values.enough()) << shape.name << k;
      EXPECT_TRUE(Check(wrong).deviations.enough()) << shape.name << k;
      wrong = shape;
      wrong.deviations[k] = Changed(shape.deviations[k], 8);
      EXPECT_TRUE(Check(wrong).values.enough()) << shape.name << k;
      EXPECT_FALSE(Check(wrong).deviations.enough()) << shape.name << k;
    }
  }
}

TEST(SelftestOwnCases, AMovedPointFails) {
  for (ExactShape shape : ExactShapes()) {
    shape.points[4][0] += 1e-3;
    EXPECT_FALSE(Check(shape).pass()) << shape.name;
  }
}

TEST(Known, DigitsAreThoseThatWerePrinted) {
  const auto digits = [](const char* text) { return ParseKnown(text)->digits; };
  EXPECT_EQ(digits("-2.5235058043E+03"), 11);
  EXPECT_EQ(digits("0.0029"), 2);
  EXPECT_EQ(digits("254.260"), 6);
  EXPECT_EQ(digits("32"), 2);
  EXPECT_EQ(digits("3.141592653589793238462643383279502884197"), 16);
  EXPECT_NEAR(ParseKnown("0.0029")->last_place, std::log10(29), 1e-12);
  EXPECT_NEAR(ParseKnown("-2.50E+03")->last_place, std::log10(250), 1e-12);
  EXPECT_NEAR(ParseKnown("0.001")->last_place, 0, 1e-12);
  for (const char* text : {"", "0.0", "b1", "1.2.3", "nan", "inf", "1e999"}) EXPECT_FALSE(ParseKnown(text)) << text;
}

TEST(Known, TheWorstNumberCounts) {
  const Digits digits = Compare(Eigen::Vector2d(1.0001, 2.02), {"1.000000000", "2.000000000"}, 8);
  EXPECT_NEAR(digits.reached, 2, 1e-9);
  EXPECT_EQ(digits.required, 8);
  EXPECT_FALSE(digits.enough());
  EXPECT_EQ(Compare(Eigen::Vector2d(1, 2), {"1.00", "2.00"}, 2).reached, 3);
}

TEST(Known, AllPublishedDigitsMeansOneUnitOfTheLast) {
  const auto enough = [](double found) {
    return Compare(Eigen::VectorXd::Constant(1, found), {"0.295"}, kAllDigits).enough();
  };
  EXPECT_TRUE(enough(0.29558));
  EXPECT_TRUE(enough(0.2941));
  EXPECT_FALSE(enough(0.2961));
  EXPECT_FALSE(enough(-0.295));
  EXPECT_FALSE(enough(std::nan("")));
}

// A file in NIST's layout, with numbers of its own; Windows' line ends.
class NistFile : public ::testing::Test {
 protected:
  NistFile() {
    for (const NistModel& model : NistModels())
      if (model.name == std::string("DanWood")) model_ = model;
  }
  Result<NistData> Read() const {
    std::string text;
    for (const std::string& line : lines_) text += line + "\r\n";
    return ReadNist(folder_.Write("test.dat", text), model_);
  }
  void ExpectRefused(const ::testing::Matcher<std::string>& sentence) const {
    const Result<NistData> data = Read();
    ASSERT_FALSE(data.ok());
    EXPECT_THAT(data.error().message, sentence);
  }
  TemporaryFolder folder_;
  NistModel model_;
  std::vector<std::string> lines_ = {"NIST/ITL StRD",
                                     "File Format:   ASCII",
                                     "               Starting Values   (lines 8 to  9)",
                                     "               Certified Values  (lines 8 to 14)",
                                     "               Data              (lines 12 to 14)",
                                     "               Lower Level of Difficulty",
                                     "        Start 1     Start 2           Parameter     Standard Deviation",
                                     "  b1 =   1           0.7           7.6886226176E-01  1.8281973860E-02",
                                     "  b2 =   5           4             3.8604055871E+00  5.1726610913E-02",
                                     " ",
                                     "Data:  y              x",
                                     "      2.138E0        1.309E0",
                                     "      3.421E0        1.471E0",
                                     "      -3.597E0       1.490E0"};
};

TEST_F(NistFile, IsReadByTheLinesThatItsHeaderNames) {
  const Result<NistData> data = Read();
  ASSERT_TRUE(data.ok()) << data.error().message;
  EXPECT_EQ(data->level, "Lower");
  EXPECT_THAT(data->start, ElementsAre(0.7, 4));
  EXPECT_THAT(data->values, ElementsAre("7.6886226176E-01", "3.8604055871E+00"));
  EXPECT_THAT(data->deviations, ElementsAre("1.8281973860E-02", "5.1726610913E-02"));
  ASSERT_EQ(data->observations.size(), 3u);
  EXPECT_EQ(data->observations[2].y, -3.597);
  EXPECT_EQ(data->observations[2].x[0], 1.490);
}

TEST_F(NistFile, WrongLinesAreNamed) {
  const auto undamaged = lines_;
  for (const auto& [number, line, expected] :
       {std::tuple{8, "  b1 =   1           0.7           7.6886226176E-01", "expected b1 = two starts"},
        std::tuple{9, "  b3 =   5           4             3.8604055871E+00  5.1726610913E-02", "expected b2 ="},
        std::tuple{9, "  b2 =   5           4             3.86O4055871E+00  5.1726610913E-02", "expected b2 ="},
        std::tuple{12, "      2.138E0", "expected 2 numbers"},
        std::tuple{13, "  3.421E0  1.471E0  9", "expected 2 numbers"},
        std::tuple{14, "  3.421E0  x", "found \"3.421E0  x\", expected 2 numbers"}, std::tuple{14, "", "expected 2"}}) {
    lines_ = undamaged;
    lines_[static_cast<size_t>(number) - 1] = line;
    ExpectRefused(AllOf(HasSubstr("test.dat:" + std::to_string(number) + ": found "), HasSubstr(expected)));
  }
}

TEST_F(NistFile, ATruncatedFile) {
  lines_.pop_back();
  ExpectRefused(HasSubstr("test.dat: found 13 lines, expected Data in lines 12 to 14"));
}

TEST_F(NistFile, OfAnotherKind) {
  lines_ = {"angle,y,z", "1,2,3"};
  ExpectRefused(HasSubstr("found no \"Starting Values (lines ... to ...)\""));
}

TEST_F(NistFile, OfAnotherModel) {
  lines_[2] = "               Starting Values   (lines 8 to  8)";
  ExpectRefused(HasSubstr("in lines 8 to 8, expected 2 parameters"));
}

TEST_F(NistFile, AKnownMisprintIsCorrectedAndTold) {
  lines_[7] = "  b1 =   1           0.7           1.20196866396E-0  1.8281973860E-02";
  EXPECT_EQ(Read()->values[0], "1.20196866396E-0");
  model_.name = "Roszman1";
  const Result<NistData> data = Read();
  EXPECT_EQ(data->values[0], "2.0196866396E-01");
  EXPECT_THAT(data->note, HasSubstr("misprints"));
}

}  // namespace
}  // namespace scancal::selftest
