// CSV of LMI's Gocators, as their manual lays it out.
#include <gmock/gmock.h>
#include "tests/io/scan_test.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string kInfo =
    "Info\r\nCSV Version,Sensor Count,Trigger Mode,Trigger Rate,XResolution,YResolution,ZResolution\r\n"
    "2,1,1,1000.00000,0.50000,0.1,0.001\r\nEnd\r\n"
    "DeviceInfo\r\nID,Model,Version\r\n13434,311320-2M-01,4.8.2.29\r\nEnd\r\n";
const std::string kAttributes = "Frame Count,Column Count,X Offset,Y Offset,Z Offset\r\n2,3,-1.5,0,0\r\n\r\n";
const std::string kStamps = "Frame,Source,Time,Encoder,Z Encoder,Inputs,Exposure,Y,Axis";
const std::string kProfile = kInfo + "Profile\r\n" + kAttributes + kStamps +
                             ",-1.5,0,1.5\r\n"
                             "7,0,100,1000,0,0,80,0,Z,5.25,,-6\r\n7,0,100,1000,0,0,80,0,I,90,0,91\r\n"
                             "8,0,200,1004,0,0,80,0,Z,5.5,-1.7976931348623157e+308,-7\r\nEnd\r\n";
const std::string kRaw = kInfo + "RawProfile\r\n" + kAttributes + kStamps +
                         ",0,1,2\r\n"
                         "1,0,100,10,0,0,80,0,X,-1,0.5,1\r\n1,0,100,10,0,0,80,0,Z,5,6,7\r\n"
                         "2,0,200,12,0,0,80,0,I,9,9,9\r\n2,0,200,12,0,0,80,0,Z,8,,9\r\n"
                         "2,0,200,12,0,0,80,0,X,-2,,2\r\nEnd\r\n";
const std::string kPart = kInfo +
                          "Part\r\nFrame,Source,Time,Encoder,Z Encoder,Inputs,Row Count,Column Count,X Offset,Y "
                          "Offset,Z Offset\r\n1,0,0,0,0,0,2,3,-1,0,0\r\n\r\n"
                          "Y\\X,-1,0,1\r\n0.0,3,,4\r\n0.5,5,6,7\r\nEnd\r\n";

class GocatorTest : public ScanFileTest {
 protected:
  ScanFormat Format(std::string_view contents) {
    ScanFormat format = ScanFileTest::Format("gocator.csv", contents);
    format.angle = Counts("Encoder");
    return format;
  }
  Scan Read(std::string_view contents) { return ReadAll(Format(contents)); }
};

TEST_F(GocatorTest, AProfileARowAtThePositionsOfTheHeader) {
  const Scan scan = Read(kProfile);
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan["angle"], ElementsAre(500, 500, 502, 502));
  EXPECT_THAT(scan["z"], ElementsAre(-1.5, 1.5, -1.5, 1.5));
  EXPECT_THAT(scan["y"], ElementsAre(5.25, -6, 5.5, -7));
  EXPECT_THAT(scan["profile"], ElementsAre(7, 7, 8, 8));
  EXPECT_THAT(scan["time"], ElementsAre(100, 100, 200, 200));
  EXPECT_EQ(scan.missing, 2);
  EXPECT_TRUE(scan.heights);
  EXPECT_EQ(scan.description, "Gocator CSV, Profile in line 9: y is its Z and z its X, in mm, counts");
}

TEST_F(GocatorTest, RowsXAndZOfAFrameInAnyOrder) {
  const Scan scan = Read(kRaw);
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan["angle"], ElementsAre(5, 5, 5, 6, 6));
  EXPECT_THAT(scan["z"], ElementsAre(-1, 0.5, 1, -2, 2));
  EXPECT_THAT(scan["y"], ElementsAre(5, 6, 7, 8, 9));
  EXPECT_EQ(scan.missing, 1);
  EXPECT_THAT(scan.description,
              HasSubstr("RawProfile in line 9: y is its Z and z its X, in mm, X Offset -1.5 not added"));
}

TEST_F(GocatorTest, APartIsATable) {
  ScanFormat format = Format(kPart);
  EXPECT_THAT(ReadAll(format).error,
              HasSubstr("expected also 'Encoder'; a surface has no angles: say angle: {start: ..., step"));
  format.angle = Counts("Y");
  EXPECT_THAT(ReadAll(format)["angle"], ElementsAre(0, 0, 0.25, 0.25, 0.25));
  format.angle = Steps(2, 0.125);
  const Scan scan = ReadAll(format);
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan["angle"], ElementsAre(2, 2, 2.125, 2.125, 2.125));
  EXPECT_THAT(scan["z"], ElementsAre(-1, 1, -1, 0, 1));
  EXPECT_THAT(scan["y"], ElementsAre(3, 4, 5, 6, 7));
}

TEST_F(GocatorTest, CountedColumnsAreAtOffsetAndResolution) {
  const std::string counted = kInfo + "Profile\n" + kAttributes + kStamps + ",0,1,2\n1,0,0,0,0,0,0,0,Z,5,6,7\nEnd\n";
  const Scan scan = Read(counted);
  EXPECT_THAT(scan["z"], ElementsAre(-1.5, -1, -0.5));
  EXPECT_THAT(scan.description, HasSubstr("X from X Offset -1.5 and the resolution 0.5"));
  EXPECT_THAT(Read(counted.substr(kInfo.size())).error, HasSubstr("found columns that are counted, 0 to 2, and no X "
                                                                  "Resolution"));
}

TEST_F(GocatorTest, OffsetsThatAreNotInThePositionsAreTold) {
  EXPECT_THAT(Read(kInfo + "Profile\nColumn Count,X Offset,Z Offset\n2,-4,100\n" + kStamps + ",3,4\nEnd\n").description,
              HasSubstr("in mm, X Offset -4 not added, Z Offset 100 not added"));
}

TEST_F(GocatorTest, WhereAndLinesChooseRows) {
  std::string two = kRaw;
  two.insert(two.rfind("End"), "3,1,300,14,0,0,80,0,Z,1,2,3\r\n3,1,300,14,0,0,80,0,X,4,5,6\r\n");
  EXPECT_THAT(Read(two).error, HasSubstr(":19: found the sources 0 and 1, which are two sensors; say which: where: "
                                         "{Source: 0}"));
  ScanFormat format = Format(two);
  format.text.where = {{"Source", "1"}};
  EXPECT_THAT(ReadAll(format)["y"], ElementsAre(1, 2, 3));
  format.text.where = {};
  format.lines = {14, 15};
  EXPECT_THAT(ReadAll(format)["y"], ElementsAre(5, 6, 7));
}

TEST_F(GocatorTest, OtherTextsForMissingAreDeclared) {
  std::string text = kProfile;
  text.replace(text.find("5.25"), 4, "no echo");
  ScanFormat format = Format(text);
  EXPECT_THAT(ReadAll(format).error, HasSubstr("found \"no echo\", expected a number"));
  format.text.missing = {"no echo"};
  format.invalid = -6;
  EXPECT_THAT(ReadAll(format)["y"], ElementsAre(5.5, -7));
}

TEST_F(GocatorTest, WithoutAnAngleTheRemedyIsTold) {
  ScanFormat format = Format(kProfile);
  format.angle.reset();
  EXPECT_THAT(ReadAll(format).error, AllOf(HasSubstr("found the columns Frame, Source, Time, Encoder"),
                                           HasSubstr("angle: {column: Encoder, counts_per_turn: ...}")));
}

TEST_F(GocatorTest, OtherSectionsAreNamed) {
  const std::string error = Read(kInfo + "SurfacePointCloud\nFrame,Source\n1,0\nEnd\n").error;
  EXPECT_EQ(error,
            Place(": found the sections Info, DeviceInfo, SurfacePointCloud of a Gocator's CSV, expected Profile, "
                  "RawProfile or Part; export profiles or a surface"));
}

TEST_F(GocatorTest, WhatIsCutOffOrDamagedIsAnErrorWithItsPlace) {
  EXPECT_THAT(Read(kProfile.substr(0, kProfile.rfind("End"))).error,
              HasSubstr(": found no row End behind Profile in line 9"));
  EXPECT_THAT(Read(kProfile.substr(0, kProfile.rfind(",-7"))).error,
              HasSubstr(":16: found 11 cells, expected 12 as in the header; the file is probably cut off"));
  std::string raw = kRaw;
  raw.replace(raw.find(",X,"), 3, ",W,");
  EXPECT_THAT(Read(raw).error, HasSubstr(":14: Axis: found \"W\", expected X, Z or I"));
  raw = kRaw;
  raw.erase(raw.find("1,0,100,10,0,0,80,0,Z"), std::string("1,0,100,10,0,0,80,0,Z,5,6,7\r\n").size());
  EXPECT_THAT(Read(raw).error, HasSubstr(": found frame 1 with a row of Axis X alone, expected one of X and one of Z"));
  std::string text = kProfile;
  text.replace(text.find("5.25"), 4, "5.2.5");
  EXPECT_THAT(Read(text).error, HasSubstr(":14:25: Z: found \"5.2.5\", expected a number"));
  EXPECT_THAT(Read(kInfo + "Profile\nFrame,Source\n").error, HasSubstr("expected its attributes: Frame Count"));
  EXPECT_THAT(Read(kInfo + "Profile\n" + kAttributes + "1,2,3\n").error, HasSubstr("expected the header of the data"));
}

TEST_F(GocatorTest, CountsInAttributesAreNotTrusted) {
  std::string text = kProfile;
  text.replace(text.find("2,3,-1.5"), 3, "999999999999,999999999999");
  EXPECT_EQ(Read(text).columns, Read(kProfile).columns);
}

TEST_F(GocatorTest, AFormatThatIsNamedIsNotLookedFor) {
  ScanFormat format = Format("\n\n" + kProfile.substr(kInfo.size()));
  EXPECT_THAT(ReadAll(format)["y"], ElementsAre(5.25, -6, 5.5, -7));
  format = Format("Encoder,y,z\n4,1,2\n");
  EXPECT_THAT(ReadAll(format)["angle"], ElementsAre(2));
  format.kind = "gocator";
  EXPECT_THAT(ReadAll(format).error, HasSubstr("of a Gocator's CSV, expected Profile"));
}

}  // namespace
}  // namespace scancal
