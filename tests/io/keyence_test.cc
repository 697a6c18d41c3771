// Text of Keyence's profilers.
#include <gmock/gmock.h>
#include <array>
#include "tests/io/scan_test.h"

namespace scancal {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::string kProfiles =
    "-200000\t150000\t-2147483648\t150\r\n"
    "0\t-2147483647\t-2147483646\t250\r\n"
    "200000\t151000\t-2147483645\t350\r\n";

class KeyenceTest : public ScanFileTest {
 protected:
  ScanFormat Format(std::string_view contents) {
    ScanFormat format = ScanFileTest::Format("keyence.tsv", contents);
    format.angle = Steps(1, 0.5);
    return format;
  }
  ScanFormat Heights(std::string_view contents) {
    ScanFormat format = Format(contents);
    format.layout = WideLayout{
        .value = "y", .across = "z", .angle_column = 0, .first_column = 1, .start = -1, .step = 0.25, .image = true};
    return format;
  }
};

auto Is(double number) { return DoubleNear(number, 1e-12); }

TEST_F(KeyenceTest, ProfilesOfAnLjVAreColumnsInHundredthsOfAMicrometre) {
  const Scan scan = ReadAll(Format(kProfiles));
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan["angle"], ElementsAre(1, 2, 2, 1, 2));
  EXPECT_THAT(scan["z"], ElementsAre(Is(-2), Is(-2), Is(0), Is(2), Is(2)));
  EXPECT_THAT(scan["y"], ElementsAre(Is(1.5), Is(0.0015), Is(0.0025), Is(1.51), Is(0.0035)));
  EXPECT_THAT(scan["profile"], ElementsAre(1, 3, 3, 1, 3));
  EXPECT_EQ(scan.missing, 4);
  EXPECT_TRUE(scan.heights);
  EXPECT_EQ(scan.description,
            "cells between tabs, Keyence LJ-V: X and a profile a column in 0.01 um, -2147483648 to -2147483645 "
            "missing, steps");
}

TEST_F(KeyenceTest, ATabBehindTheLastProfileIsNoProfile) {
  const Scan scan = ReadAll(Format("0\t100000\t\r\n100\t-2147483648\t\r\n200\t300000\t\r\n"));
  EXPECT_THAT(scan["y"], ElementsAre(Is(1), Is(3)));
  EXPECT_EQ(scan.missing, 1);
}

TEST_F(KeyenceTest, TheDeclaredUnitOfLengthDoesNotCount) {
  ScanFormat format = Format(kProfiles);
  format.units.length_in_mm = 1000;
  EXPECT_EQ(ReadAll(format).columns, ReadAll(Format(kProfiles)).columns);
}

TEST_F(KeyenceTest, AnglesInAFileByTheNumberOfTheProfile) {
  ScanFormat format = Format(kProfiles);
  format.angle.reset();
  EXPECT_THAT(ReadAll(format).error, HasSubstr("a profile a column has no angles; add angle: {start: ..., step: ...}, "
                                               "or {file: ..., by: profile, column: ...}"));
  format.angle = Counts("Encoder");
  EXPECT_THAT(ReadAll(format).error, HasSubstr("has no angles"));
  format.angle->file = folder_.Write("angles.csv", "profile,Encoder\n1,10\n3,14\n2,11\n");
  format.angle->by = "profile";
  EXPECT_THAT(ReadAll(format)["angle"], ElementsAre(5, 7, 7, 5, 7));
}

TEST_F(KeyenceTest, OtherNumbersBetweenTabsAreNoProfiles) {
  for (const char* other : {"-2\t1.5\n0\t2\n2\t3\n", "-2\t1\n0\t2\n3\t3\n", "0\t1\n0\t2\n0\t3\n", "1\n2\n3\n",
                            "x\ty\n0\t1\n1\t1\n", "0\t1\n1\t2\n"}) {
    EXPECT_THAT(ReadAll(Format(other)).error, Not(IsEmpty())) << other;
    ScanFormat named = Format(other);
    named.kind = "lj-v";
    EXPECT_THAT(ReadAll(named).description, HasSubstr("Keyence LJ-V")) << other;
  }
  ScanFormat declared = Format(kProfiles);
  declared.npy_columns = {"y", "z", "profile", "time"};
  EXPECT_THAT(ReadAll(declared)["y"], ElementsAre(-200000, 0, 200000));
}

TEST_F(KeyenceTest, HeightsOfAnLjXAreRowsInMillimetres) {
  const Scan scan = ReadAll(Heights("1.5000,-99999.9999,1.7000\n-99999.9999,2.0000,2.1000\n"));
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan["angle"], ElementsAre(1, 1, 1.5, 1.5));
  EXPECT_THAT(scan["z"], ElementsAre(-1, -0.5, -0.75, -0.5));
  EXPECT_THAT(scan["y"], ElementsAre(1.5, 1.7, 2, 2.1));
  EXPECT_EQ(scan.missing, 2);
  EXPECT_TRUE(scan.heights);
  EXPECT_EQ(scan.description, "Keyence LJ-X heights in mm, -99999.9999 missing, steps");
}

TEST_F(KeyenceTest, HeightsAreInMillimetresWhateverIsDeclared) {
  ScanFormat format = Heights("1.5,-99999.9999\n2,3\n");
  format.units.length_in_mm = 1000;
  EXPECT_THAT(ReadAll(format)["y"], ElementsAre(1.5, 2, 3));
  EXPECT_THAT(ReadAll(format)["z"], ElementsAre(-1000, -1000, -750));
}

TEST_F(KeyenceTest, HeightsWithoutPlacesAreRefused) {
  ScanFormat format = Format("1.5,2\n2,3\n");
  format.kind = "lj-x";
  EXPECT_EQ(
      ReadAll(format).error,
      Place(": the heights of a Keyence LJ-X say nothing of their places, expected layout: {image: y, start: ..., "
            "step: ...}, along the line"));
}

TEST_F(KeyenceTest, OtherHeightsInTextAreReadAsTheyAre) {
  const Scan scan = ReadAll(Heights("1.5,-5\n2,3\n"));
  EXPECT_THAT(scan["y"], ElementsAre(1.5, -5, 2, 3));
  EXPECT_EQ(scan.description, "steps");
}

TEST_F(KeyenceTest, ALineThatIsCutOffIsAnError) {
  EXPECT_THAT(ReadAll(Format(kProfiles + "400000\t1")).error,
              HasSubstr(":4: found 1 cells from column 2 on, expected 3 as before; the file is probably cut off here"));
}

TEST_F(KeyenceTest, AnotherFormatThanTheNamedIsTold) {
  const std::string ljv = "-200000\t1500\t7\n0\t250\t250\n200000\t151\t350\n";
  const std::string names = "angle,y,z\n1,2,3\n", array = "\x93NUMPY\1";
  for (const auto& [kind, contents, sentence] : std::vector<std::array<std::string, 3>>{
           {"gocator", ljv, ": found Keyence LJ-V profiles, expected Gocator CSV as format: gocator says"},
           {"ply", ljv, ": found Keyence LJ-V profiles, expected PLY as format: ply says"},
           {"lj-v", array, ": found an array or an image, expected Keyence LJ-V profiles as format: lj-v says"},
           {"gocator", names, ": found none of the sections of a Gocator's CSV, expected Profile, RawProfile or Part"},
           {"lj-v", names, ": found no tabs, expected profiles of a Keyence LJ-V"},
           {"lj-x", names, ": the heights of a Keyence LJ-X say nothing of their places, expected layout: {image: y"},
           {"image", names, ": found neither a PNG, a TIFF nor a .npy file"},
           {"ply", names, ":1: found other data, expected the line ply that a PLY begins with"},
           {"pcd", names, ": found no line FIELDS, expected the header of a PCD"}}) {
    ScanFormat format = ScanFileTest::Format("file", contents);
    format.kind = kind;
    format.angle = Steps(0, 1);
    EXPECT_THAT(ReadAll(format).error, HasSubstr(sentence)) << kind;
  }
}

}  // namespace
}  // namespace scancal
