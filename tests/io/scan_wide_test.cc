// Scans with one profile per line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include "io/units.h"
#include "tests/io/scan_test.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::DoubleEq;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ScanWideTest : public ::testing::Test {
 protected:
  ScanFormat Format(std::string_view contents) {
    ScanFormat format;
    format.path = folder_.Write("wide's.csv", contents);
    format.columns = {{"angle", Dimension::kAngle}, {"y", Dimension::kLength}, {"z", Dimension::kLength}};
    format.layout =
        WideLayout{.value = "y", .across = "z", .angle_column = 2, .first_column = 3, .start = -1, .step = 0.5};
    return format;
  }
  Scan Read(std::string_view contents) { return ReadAll(Format(contents)); }
  std::string Place(const std::string& place) { return (folder_.path() / "wide's.csv").string() + place; }

  TemporaryFolder folder_;
};

TEST_F(ScanWideTest, EveryCellIsAPoint) {
  const Scan scan = Read("# time,angle,cells\nx,90,7,8,9\ny,180,1,2,3");
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.names, ElementsAre("angle", "z", "y", "profile"));
  const double quarter = 90 * kDegree, half = 180 * kDegree;
  EXPECT_THAT(scan.columns[0], ElementsAre(quarter, quarter, quarter, half, half, half));
  EXPECT_THAT(scan.columns[1], ElementsAre(-1, -0.5, 0, -1, -0.5, 0));
  EXPECT_THAT(scan.columns[2], ElementsAre(7, 8, 9, 1, 2, 3));
  EXPECT_THAT(scan.columns[3], ElementsAre(2, 2, 2, 3, 3, 3));
}

TEST_F(ScanWideTest, BearingsAreAngles) {
  ScanFormat format = Format("0,0,2\n");
  format.columns = {{"angle", Dimension::kAngle}};
  format.units = {.length = "m", .angle = "deg", .length_in_mm = 1000, .angle_in_rad = kDegree};
  format.layout->value = "range";
  format.layout->across = "bearing";
  format.layout->start = -90;
  const Scan scan = ReadAll(format);
  EXPECT_THAT(scan.names, ElementsAre("angle", "bearing", "range", "profile"));
  EXPECT_THAT(scan.columns[1], ElementsAre(DoubleEq(-90 * kDegree)));
  EXPECT_THAT(scan.columns[2], ElementsAre(2000));
}

TEST_F(ScanWideTest, AHeaderIsOptionalAndItsUnitsWin) {
  const Scan scan = Read("time,angle_rad,y_um,y_um\r\n0,0.5,7,8\r\n");
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.columns[0], ElementsAre(0.5, 0.5));
  EXPECT_THAT(scan.columns[2], ElementsAre(7 * 0.001, 8 * 0.001));
}

TEST_F(ScanWideTest, EmptyAndInvalidCellsAreMissingPoints) {
  ScanFormat format = Format("0,1,,8,\n0,1,-9999,nan,9\n");
  format.invalid = -9999;
  const Scan scan = ReadAll(format);
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.columns[1], ElementsAre(-0.5, 0));
  EXPECT_THAT(scan.columns[2], ElementsAre(8, 9));
  EXPECT_EQ(scan.missing, 4);
}

TEST_F(ScanWideTest, WithoutAnAngleTheWholeLineIsMissing) {
  const Scan scan = Read("0,,7,8\n0,nan,7,8\n0,1,7,8\n");
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.columns[2], ElementsAre(7, 8));
  EXPECT_EQ(scan.missing, 4);
}

TEST_F(ScanWideTest, KeepsOnlyTheWantedLines) {
  ScanFormat format = Format("t,angle,y\n0,1,2\n0,1,3\n0,1,4\n0,1,broken\n");
  format.lines = {3, 4};
  const Scan scan = ReadAll(format);
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.columns[2], ElementsAre(3, 4));
  EXPECT_THAT(scan.columns[3], ElementsAre(3, 4));
}

TEST_F(ScanWideTest, ManyProfilesComeInBatches) {
  std::string contents;
  for (int i = 0; i < 3000; ++i) {
    contents += "0," + std::to_string(i);
    for (int k = 0; k < 101; ++k) contents += ",2.5";
    contents += '\n';
  }
  auto reader = ScanReader::Open(Format(contents));
  ScanBatch batch;
  size_t points = 0, batches = 0;
  for (; *(*reader)->Next(&batch); ++batches) {
    points += batch.size();
    EXPECT_LT(batch.size(), 8400U);
  }
  EXPECT_EQ(points, 303'000U);
  EXPECT_GT(batches, 3U);
}

TEST_F(ScanWideTest, TextInACellIsAnErrorWithItsPlace) {
  EXPECT_EQ(Read("0,1,2,3\n0,1,2,x7\n").error, Place(":2:7: y: found \"x7\", expected a number"));
}

TEST_F(ScanWideTest, ABrokenAngleIsAnErrorAndNoHeader) {
  EXPECT_EQ(Read("0,1.2.3,2,3\n0,1,2,3\n").error, Place(":1:3: angle: found \"1.2.3\", expected a number"));
  EXPECT_THAT(Read("0,1,2\n0,inf,2\n").error, HasSubstr(":2:3: angle: found \"inf\", expected a finite number"));
}

TEST_F(ScanWideTest, DifferentNumbersOfCellsAreAnError) {
  EXPECT_EQ(Read("0,1,2,3\n0,1,2\n0,1,2,3\n").error, Place(":2: found 1 cells from column 3 on, expected 2 as before"));
  EXPECT_EQ(Read("0,1,2,3\n0,1,2,3,4\n").error, Place(":2: found 3 cells from column 3 on, expected 2 as before"));
}

TEST_F(ScanWideTest, AWrongCellIsToldBeforeTheNumberOfCells) {
  EXPECT_EQ(Read("0,1,2,3\n0,1,2,3,x\n").error, Place(":2:9: y: found \"x\", expected a number"));
  EXPECT_EQ(Read("0,1,2,3\n0,1,x\n").error, Place(":2:5: y: found \"x\", expected a number"));
}

TEST_F(ScanWideTest, AQuoteBehindABlankIsPartOfAnIgnoredCell) {
  const Scan scan = Read(" \"t,90,7,8\n \"t, 180, \"1\",2\n\"t, u\",90,3,4\n");
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.columns[2], ElementsAre(7, 8, 1, 2, 3, 4));
}

TEST_F(ScanWideTest, ATruncatedLastLineIsAnError) {
  EXPECT_EQ(Read("0,1,2,3\n0,1,2").error,
            Place(":2: found 1 cells from column 3 on, expected 2 as before; the file is probably cut off here"));
}

TEST_F(ScanWideTest, NoCellsAtAllAreAnError) {
  EXPECT_EQ(Read("0,1\n").error, Place(":1: found 0 cells from column 3 on, expected at least one"));
  ScanFormat format = Format("0,1,2,3\n");
  format.layout->first_column = 1'000'000'000;
  EXPECT_EQ(ReadAll(format).error, Place(":1: found 0 cells from column 1000000000 on, expected at least one"));
}

TEST_F(ScanWideTest, SemicolonsAreFound) {
  EXPECT_EQ(Read("0;1;2;3\n0;1;2;3\n").columns, Read("0,1,2,3\n0,1,2,3\n").columns);
}

TEST_F(ScanWideTest, AnEmptyFileAndAHeaderAloneHaveNoPoints) {
  EXPECT_EQ(Read("").error, Place(": no points: the file is empty"));
  EXPECT_THAT(Read("t,angle,y\n").error, HasSubstr(": no points: found at most a header"));
}

TEST_F(ScanWideTest, AnImpossibleLayoutIsAnError) {
  ScanFormat format = Format("0,1,2\n");
  format.layout->first_column = 2;
  EXPECT_THAT(ReadAll(format).error, AllOf(HasSubstr("found angle_column: 2, first_column: 2"),
                                           HasSubstr("expected the column of the angle, counted from 1, before")));
}

TEST_F(ScanWideTest, AMissingFileIsAnError) {
  ScanFormat format = Format("");
  format.path = folder_.path() / "absent.csv";
  EXPECT_EQ(ReadAll(format).error, format.path.string() + ": no such file");
}

}  // namespace
}  // namespace scancal
