// Scans with one point per line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <cmath>
#include <thread>
#include "io/scan.h"
#include "io/units.h"
#include "tests/io/scan_test.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class ScanCsvTest : public ::testing::Test {
 protected:
  // The format of a turntable's scan with these contents.
  ScanFormat Format(std::string_view contents) {
    ScanFormat format;
    format.path = folder_.Write("left scan.csv", contents);
    format.columns = {{"angle", Dimension::kAngle},
                      {"y", Dimension::kLength},
                      {"z", Dimension::kLength},
                      {"profile", Dimension::kNone, false}};
    return format;
  }
  Scan Read(std::string_view contents) { return ReadAll(Format(contents)); }
  std::string Place(const std::string& place) { return (folder_.path() / "left scan.csv").string() + place; }

  TemporaryFolder folder_;
};

TEST_F(ScanCsvTest, ReadsColumnsInAnyOrderInMillimetresAndRadians) {
  const Scan scan = Read("z,ignored,y,angle\n1,x,2,180\n3,,4,-90\n");
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.names, ElementsAre("angle", "y", "z"));
  EXPECT_THAT(scan.columns[0], ElementsAre(180 * kDegree, -90 * kDegree));
  EXPECT_THAT(scan.columns[1], ElementsAre(2, 4));
  EXPECT_THAT(scan.columns[2], ElementsAre(1, 3));
  EXPECT_EQ(scan.missing, 0);
}

TEST_F(ScanCsvTest, DeclaredUnitsHoldUnlessAColumnSaysOtherwise) {
  ScanFormat format = Format("angle_rad,y,z_um\n0.5,2,3\n");
  format.units = {.length = "m", .angle = "deg", .length_in_mm = 1000, .angle_in_rad = kDegree};
  const Scan scan = ReadAll(format);
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.names, ElementsAre("angle", "y", "z"));
  EXPECT_THAT(scan.columns[0], ElementsAre(0.5));
  EXPECT_THAT(scan.columns[1], ElementsAre(2000));
  EXPECT_THAT(scan.columns[2], ElementsAre(0.003));
}

TEST_F(ScanCsvTest, AColumnWithoutDimensionStaysAsItIs) {
  const Scan scan = Read("angle,y,z,profile\n1,2,3,17\n");
  EXPECT_THAT(scan.names, ElementsAre("angle", "y", "z", "profile"));
  EXPECT_THAT(scan.columns[3], ElementsAre(17));
}

TEST_F(ScanCsvTest, HeaderNamesMayBePaddedAndQuoted) {
  const Scan scan = Read(" \"angle\" , \"y_mm\",\tz \n1,2,3\n");
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.columns[2], ElementsAre(3));
}

TEST_F(ScanCsvTest, ByteOrderMarkCrLfCommentsBlankLinesAndNoFinalNewlineAreFine) {
  const Scan scan = Read("\xEF\xBB\xBF# made by a scanner\r\n\r\nangle,y,z\r\n1,2,3\r\n# 4,5\r\n  \r\n4,5,6");
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.columns[1], ElementsAre(2, 5));
  EXPECT_THAT(scan.columns[2], ElementsAre(3, 6));
}

TEST_F(ScanCsvTest, NumbersOfManyForms) {
  const Scan scan = Read("angle_rad,y,z\n+1.5, 1.5 ,\"1.5\"\n1e-320,1e-400,-.5\n1.5E1,0.1234567890123456789,5.\n");
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.columns[0], ElementsAre(1.5, 1e-320, 15));
  EXPECT_THAT(scan.columns[1], ElementsAre(1.5, 0, 0.1234567890123456789));
  EXPECT_THAT(scan.columns[2], ElementsAre(1.5, -0.5, 5));
}

TEST_F(ScanCsvTest, MissingPointsAreLeftOutAndCounted) {
  ScanFormat format = Format("angle,y,z,extra\n1,,3,0\n1,nan,3,0\n1,2,NaN,0\n,,,\n1,-9999,3,0\n1,2,3,\n1,2,3,nan\n");
  format.invalid = -9999;
  const Scan scan = ReadAll(format);
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.columns[1], ElementsAre(2, 2));
  EXPECT_EQ(scan.missing, 5);
}

TEST_F(ScanCsvTest, InvalidIsMeantAsItStandsInTheFile) {
  ScanFormat format = Format("angle,y_m,z\n1,0.5,0\n1,0.4,0\n");
  format.invalid = 0.5;  // 500 mm
  EXPECT_THAT(ReadAll(format).columns[1], ElementsAre(400));
}

TEST_F(ScanCsvTest, QuotedTextInIgnoredColumnsMayHoldCommas) {
  const Scan scan = Read("angle,note,y,z\n1,\"a, \"\"b\"\", c\",2,3\n");
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.columns[1], ElementsAre(2));
}

TEST_F(ScanCsvTest, AQuoteBehindABlankIsPartOfAnIgnoredCell) {
  const Scan scan = Read("note,angle,y,z\n \"a,1, \"2\",3\n");
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.columns[1], ElementsAre(2));
}

TEST_F(ScanCsvTest, KeepsOnlyTheWantedLinesOfTheFile) {
  ScanFormat format = Format("# comment\nangle,y,z\n1,3,0\n1,4,0\n\n1,6,0\nbroken\n");
  format.lines = {4, 6};
  const Scan scan = ReadAll(format);
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.columns[1], ElementsAre(4, 6));
}

TEST_F(ScanCsvTest, WantedLinesBeyondTheEndAreNoPoints) {
  ScanFormat format = Format("angle,y,z\n1,3,0\n");
  format.lines = {10, 20};
  EXPECT_EQ(ReadAll(format).error, Place(": no points in the lines 10 to 20"));
}

TEST_F(ScanCsvTest, LargeFilesComeInBatchesAndTellTheirProgress) {
  constexpr int kPoints = 350'000;
  std::string contents = "angle,y,z\n";
  for (int i = 0; i < kPoints; ++i) contents += "1.5," + std::to_string(i) + ",2.25\n";
  auto reader = ScanReader::Open(Format(contents));
  ASSERT_TRUE(reader.ok()) << reader.error().message;
  EXPECT_EQ((*reader)->bytes_total(), static_cast<int64_t>(contents.size()));
  ScanBatch batch;
  double expected = 0;
  size_t batches = 0;
  int64_t bytes_before = 0;
  for (;; ++batches) {
    const auto more = (*reader)->Next(&batch);
    ASSERT_TRUE(more.ok()) << more.error().message;
    if (!*more) break;
    ASSERT_LE(batch.size(), 100'000U);
    EXPECT_GT((*reader)->bytes_read(), bytes_before);
    bytes_before = (*reader)->bytes_read();
    for (const double y : batch.columns[1]) ASSERT_EQ(y, expected++);
  }
  EXPECT_EQ(expected, kPoints);
  EXPECT_GT(batches, 3U);
  EXPECT_EQ(batch.size(), 0U);
  EXPECT_EQ((*reader)->bytes_read(), (*reader)->bytes_total());
  EXPECT_FALSE(*(*reader)->Next(&batch));
}

TEST_F(ScanCsvTest, ALineLongerThanABlockIsRead) {
  const std::string blanks(3'000'000, ' ');
  const Scan scan = Read("angle,y,z\n1,2,3\n1," + blanks + "4,3\n1,5,6\n");
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.columns[1], ElementsAre(2, 4, 5));
}

TEST_F(ScanCsvTest, APipeIsRead) {
  ScanFormat format = Format("");
  format.path = folder_.path() / "pipe.csv";
  ASSERT_EQ(::mkfifo(format.path.c_str(), 0600), 0);
  std::thread writer([&] { folder_.Write("pipe.csv", "angle,y,z\n1,2,3\n"); });
  const Scan scan = ReadAll(format);
  writer.join();
  EXPECT_THAT(scan.columns[1], ElementsAre(2));
}

TEST_F(ScanCsvTest, FindGivesTheIndexOfAColumn) {
  const ScanBatch batch{.names = {"angle", "y"}, .columns = {}};
  EXPECT_EQ(batch.Find("y"), 1);
  EXPECT_EQ(batch.Find("z"), -1);
}

TEST_F(ScanCsvTest, TextInANumberIsAnErrorWithItsPlace) {
  EXPECT_EQ(Read("angle,y,z\n1,2,3\n-15.000,12.3.4,3\n").error, Place(":3:9: y: found \"12.3.4\", expected a number"));
}

TEST_F(ScanCsvTest, TheColumnOfAnErrorCountsCharactersOfTheCellItself) {
  EXPECT_EQ(Read("note,angle,y,z\n\xC3\xA4\xC3\xB6,1,  x,3\n").error, Place(":2:8: y: found \"x\", expected a number"));
}

TEST_F(ScanCsvTest, InfinityIsAnError) {
  EXPECT_EQ(Read("angle,y,z\n1,2,-inf\n").error,
            Place(":2:5: z: found \"-inf\", expected a finite number; a missing point is nan or empty"));
}

TEST_F(ScanCsvTest, AnErrorBehindAMissingCellIsStillAnError) {
  EXPECT_THAT(Read("angle,y,z\n1,,inf\n").error, HasSubstr(":2:4: z: found \"inf\""));
}

TEST_F(ScanCsvTest, OverflowIsAnError) {
  EXPECT_EQ(Read("angle,y,z\n1,1e999,3\n").error,
            Place(":2:3: y: found \"1e999\", expected a number within +-1.8e308"));
}

TEST_F(ScanCsvTest, TheLineOfAnErrorCountsSkippedLines) {
  EXPECT_THAT(Read("# one\n\nangle,y,z\n# four\n1,2,x\n").error, HasSubstr("left scan.csv:5:5: z: found \"x\""));
}

TEST_F(ScanCsvTest, ATruncatedLastLineIsAnError) {
  EXPECT_EQ(Read("angle,y,z\n1,2,3\n1,2").error,
            Place(":3: found 2 cells, expected 3 (angle, y, z); the file is probably cut off here"));
}

TEST_F(ScanCsvTest, TooFewCellsAreAnError) {
  EXPECT_EQ(Read("angle,y,z\n1\n1,2,3\n").error, Place(":2: found 1 cell, expected 3 (angle, y, z)"));
}

TEST_F(ScanCsvTest, AWrongCellIsToldBeforeTheNumberOfCells) {
  EXPECT_EQ(Read("angle,y_m,z\n1,x\n").error, Place(":2:3: y: found \"x\", expected a number"));
}

TEST_F(ScanCsvTest, TooManyCellsAreAnError) {
  EXPECT_EQ(Read("angle,y,z\n1,2,3,4\n").error, Place(":2: found 4 cells, expected 3 (angle, y, z)"));
}

TEST_F(ScanCsvTest, AMissingColumnIsAnErrorThatListsWhatIsThere) {
  EXPECT_EQ(Read("angle,x,z_deg\n1,2,3\n").error,
            Place(":1: found the columns angle, x, z_deg, expected also 'y' (or y_mm, _m, _um)"));
}

TEST_F(ScanCsvTest, AColumnTwiceIsAnError) {
  EXPECT_EQ(Read("angle,y,z,y_mm\n1,2,3,4\n").error,
            Place(":1: found the column 'y' twice, as 'y' and 'y_mm', expected it once"));
}

TEST_F(ScanCsvTest, NumbersWithoutHeaderAreAnError) {
  EXPECT_THAT(
      Read("1,2,3\n4,5,6\n").error,
      StartsWith(
          Place(":1: found numbers, expected a header line with the names of the columns; or columns: [angle, y, z] in "
                "the data set, in the order of the file; tried too: Gocator CSV, Keyence LJ-V profiles")));
}

TEST_F(ScanCsvTest, OtherSeparatorsThanTheHeadersAreAnErrorThatSaysSo) {
  EXPECT_THAT(Read("1,5;2,5;3,5\n").error,
              AllOf(HasSubstr("found numbers, expected a header"), HasSubstr("semicolons")));
  EXPECT_THAT(Read("angle,y,z\n1;2;3\n").error, HasSubstr("the cells are separated by semicolons, expected commas"));
  EXPECT_THAT(Read("1\t2\t3\n").error, AllOf(HasSubstr("expected a header"), HasSubstr("cells between tabs")));
}

TEST_F(ScanCsvTest, CarriageReturnsAloneAreAnErrorThatSaysSo) {
  EXPECT_THAT(Read("angle,y,z\r1,2,3\r").error, HasSubstr("the lines end with carriage returns alone"));
}

TEST_F(ScanCsvTest, AnEmptyFileHasNoPoints) { EXPECT_EQ(Read("").error, Place(": no points: the file is empty")); }

TEST_F(ScanCsvTest, AHeaderAloneHasNoPoints) {
  const std::string expected = Place(": no points: found at most a header and comments, expected lines of data");
  EXPECT_EQ(Read("angle,y,z\n").error, expected);
  EXPECT_EQ(Read("# nothing yet\n").error, expected);
}

TEST_F(ScanCsvTest, AMissingFileIsAnErrorWithTheNearestName) {
  ScanFormat format = Format("angle,y,z\n1,2,3\n");
  format.path.replace_filename("left scam.csv");
  EXPECT_EQ(ReadAll(format).error, format.path.string() + ": no such file; did you mean 'left scan.csv'?");
  format.path = folder_.path() / "nowhere" / "x.csv";
  EXPECT_EQ(ReadAll(format).error, format.path.string() + ": no such file");
}

TEST_F(ScanCsvTest, AFolderIsAnError) {
  ScanFormat format = Format("");
  format.path = folder_.path();
  EXPECT_EQ(ReadAll(format).error, folder_.path().string() + ": found a folder, expected a file");
}

TEST_F(ScanCsvTest, BinaryDataAreAnError) {
  EXPECT_THAT(Read(std::string_view("\x01\x00\x02\x03", 4)).error,
              StartsWith(Place(": found binary data, expected text with commas; tried too: ")));
  EXPECT_THAT(Read(std::string_view("\xFF\xFE\x61\x00", 4)).error, HasSubstr("found the columns x, expected"));
}

}  // namespace
}  // namespace scancal
