// PLY and PCD with a column of angles or profiles.
#include <gmock/gmock.h>
#include <cstring>
#include <limits>
#include "tests/io/scan_test.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

template <class... Numbers>
std::string Bytes(Numbers... numbers) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&numbers), sizeof numbers), ...);
  return bytes;
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

const std::string kPlyColumns =
    "property float y\nproperty double z\nproperty short Encoder\nproperty uchar intensity\n";
const std::string kPlyFaces = "element face 1\nproperty list uchar int vertex_indices\n";
std::string PlyHead(const std::string& format, const std::string& points) {
  return "ply\nformat " + format + " 1.0\ncomment by hand\nelement vertex " + points + "\n" + kPlyColumns + kPlyFaces +
         "end_header\n";
}
std::string AsciiPly(const std::string& points = "3") {
  return PlyHead("ascii", points) + "1.5 -2 10 255\nnan 3 10 0\n 2.5 4 -12 7 \n3 0 1 2\n";
}
std::string BinaryPly(const std::string& points = "3") {
  return PlyHead("binary_little_endian", points) + Bytes(1.5F, -2.0, int16_t{10}, uint8_t{255}) +
         Bytes(kNan, 3.0, int16_t{10}, uint8_t{0}) + Bytes(2.5F, 4.0, int16_t{-12}, uint8_t{7}) +
         Bytes(uint8_t{3}, 0, 1, 2);
}

std::string PcdHead(const std::string& data, const std::string& points) {
  return "# .PCD v.7 - Point Cloud Data file format\nVERSION .7\nFIELDS y _ z Encoder\nSIZE 4 1 8 2\nTYPE F U F I\n"
         "COUNT 1 3 1 1\nWIDTH " +
         points + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + points + "\nDATA " + data + "\n";
}
std::string AsciiPcd(const std::string& points = "3") {
  return PcdHead("ascii", points) + "1.5 0 0 0 -2 10\nnan 0 0 0 3 10\n2.5 9 9 9 4 -12\n";
}
std::string BinaryPcd(const std::string& points = "3") {
  const std::string gap(3, '\7');
  return PcdHead("binary", points) + Bytes(1.5F) + gap + Bytes(-2.0, int16_t{10}) + Bytes(kNan) + gap +
         Bytes(3.0, int16_t{10}) + Bytes(2.5F) + gap + Bytes(4.0, int16_t{-12});
}

class CloudTest : public ScanFileTest {
 protected:
  ScanFormat Format(std::string_view contents) {
    ScanFormat format = ScanFileTest::Format("cloud", contents);
    format.angle = Counts("Encoder");
    return format;
  }
  Scan Read(std::string_view contents) { return ReadAll(Format(contents)); }
};

TEST_F(CloudTest, TheSamePointsInEachOfThem) {
  for (const std::string& contents : {AsciiPly(), BinaryPly(), AsciiPcd(), BinaryPcd()}) {
    const Scan scan = Read(contents);
    EXPECT_THAT(scan.error, IsEmpty());
    EXPECT_THAT(scan["angle"], ElementsAre(5, -6));
    EXPECT_THAT(scan["y"], ElementsAre(1.5, 2.5));
    EXPECT_THAT(scan["z"], ElementsAre(-2, 4));
    EXPECT_EQ(scan.missing, 1);
  }
  EXPECT_EQ(Read(BinaryPly()).description, "PLY, binary: angle is its Encoder, y, z, counts");
  EXPECT_THAT(Read(AsciiPcd()).description, HasSubstr("PCD, ascii: "));
}

TEST_F(CloudTest, NamesUnitsInvalidWhereAndLinesAsInText) {
  ScanFormat format = Format(
      "ply\r\nformat ascii 1.0\r\nelement vertex 4\r\nproperty float x_um\r\nproperty float depth\r\nproperty int "
      "head\r\nproperty int profile\r\nend_header\r\n1000 2 0 1\r\n2000 -1 0 2\r\n3000 4 1 3\r\n4000 5 0 4\r\n");
  format.angle = Steps(1, 0.5);
  format.names = {{"y", "depth"}, {"z", "x"}};
  format.units.length_in_mm = 1000;
  format.invalid = -1;
  format.text.where = {{"head", "0"}};
  const Scan scan = ReadAll(format);
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan["angle"], ElementsAre(1, 2.5));
  EXPECT_THAT(scan["y"], ElementsAre(2000, 5000));
  EXPECT_THAT(scan["z"], ElementsAre(1, 4));
  EXPECT_EQ(scan.missing, 1);
  format.lines = {4, 9};
  EXPECT_THAT(ReadAll(format)["z"], ElementsAre(4));
}

TEST_F(CloudTest, ARegisteredCloudIsRefusedWithTheReason) {
  const std::string places =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 "
      "3\n";
  ScanFormat format = Format(places);
  format.angle.reset();
  EXPECT_EQ(
      ReadAll(format).error,
      Place(": found a cloud of x, y, z without the angle of each point: it is registered already, with the angles "
            "and offsets that are looked for here; export the points as the sensor saw them, and name the column: "
            "columns: {angle: ...}"));
  format.angle = Steps(0, 1);
  EXPECT_THAT(ReadAll(format).error, HasSubstr("without the profile of each point"));
}

TEST_F(CloudTest, WhichAxisIsTheDepthMustBeDeclared) {
  ScanFormat format = Format(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float "
      "Encoder\nend_header\n1 2 3 4\n");
  EXPECT_THAT(ReadAll(format).error, HasSubstr(": found a cloud of x, y, z, Encoder, expected which is the depth and "
                                               "which runs along the line: columns: {y: z, z: x}"));
  format.names = {{"y", "z"}, {"z", "x"}};
  EXPECT_THAT(ReadAll(format)["y"], ElementsAre(3));
  EXPECT_THAT(ReadAll(format)["z"], ElementsAre(1));
}

TEST_F(CloudTest, PointsOfABallAreReadAsTheyAre) {
  ScanFormat format = Format(AsciiPly());
  format.angle.reset();
  format.one_of.clear();
  format.columns = {{"y", Dimension::kLength}, {"z", Dimension::kLength}};
  EXPECT_THAT(ReadAll(format).columns, ElementsAre(ElementsAre(1.5, 2.5), ElementsAre(-2, 4)));
}

TEST_F(CloudTest, CountsInHeadersAreNotTrusted) {
  for (const std::string& contents :
       {AsciiPcd("4503599627370496"), BinaryPcd("4503599627370496"), BinaryPly("900719925474")})
    EXPECT_THAT(Read(contents).error,
                AllOf(HasSubstr(": found 3 points, expected "), HasSubstr("the file is probably cut off")));
  EXPECT_THAT(Read(AsciiPly("5")).error, HasSubstr(": found 4 points, expected 5 as its header says"));
  std::string wide = BinaryPcd();
  wide.replace(wide.find("COUNT 1 3"), 9, "COUNT 1 99999");
  EXPECT_THAT(Read(wide).error, HasSubstr(": found 0 points, expected 3"));
  wide.replace(wide.find("99999"), 5, "99999999999");
  EXPECT_THAT(Read(wide).error, HasSubstr(":6: found \"COUNT 1 99999999999 1 1\", expected numbers, one for each"));
  EXPECT_THAT(Read(AsciiPly("0")).error, HasSubstr(": no points"));
  for (const std::string& contents : {AsciiPcd("2"), BinaryPcd("2")})
    EXPECT_THAT(Read(contents).error, HasSubstr(": found more behind the 2 points that its head counts"));
}

TEST_F(CloudTest, OtherHeadsAreErrorsWithTheirLine) {
  const auto with = [](std::string text, const std::string& old, const std::string& now) {
    return text.replace(text.find(old), old.size(), now);
  };
  EXPECT_THAT(Read(with(AsciiPly(), "ascii", "binary_big_endian")).error,
              HasSubstr(":2: found \"format binary_big_endian 1.0\", expected format ascii or binary_little_endian"));
  EXPECT_THAT(Read(with(AsciiPly(), "element vertex 3", "element edge 3")).error,
              HasSubstr(":4: found \"element edge 3\", "
                        "expected element vertex first"));
  EXPECT_THAT(Read(with(AsciiPly(), "float y", "list uchar int y")).error, HasSubstr("a property of one number"));
  EXPECT_THAT(Read(with(AsciiPly(), "vertex 3", "vertex -3")).error, HasSubstr("expected element vertex COUNT"));
  EXPECT_THAT(Read(PlyHead("ascii", "3").substr(0, 60)).error, HasSubstr(": the file is cut off in its header"));
  EXPECT_THAT(Read(with(BinaryPcd(), "DATA binary", "DATA binary_compressed")).error,
              HasSubstr(":11: found \"DATA binary_compressed\", expected DATA ascii or binary"));
  EXPECT_THAT(Read(with(AsciiPcd(), "SIZE 4 1 8 2", "SIZE 4 1 8 3")).error, HasSubstr(":4: found \"SIZE 4 1 8 3\""));
  EXPECT_THAT(Read(with(AsciiPcd(), "FIELDS y _ z Encoder", "FIELDS")).error, HasSubstr(":4: found"));
  EXPECT_THAT(Read(with(AsciiPcd(), "FIELDS", "fields")).error, HasSubstr(": found"));
}

TEST_F(CloudTest, WrongNumbersAreErrorsWithTheirPlace) {
  const auto with = [](const std::string& now) {
    std::string text = AsciiPly();
    return text.replace(text.find("1.5 -2 10 255"), 13, now);
  };
  EXPECT_THAT(Read(with("1.5 -2 1o 255")).error, HasSubstr(":12: Encoder: found \"1o\", expected a number"));
  EXPECT_THAT(Read(with("1.5 -2 10")).error, HasSubstr(":12: intensity: found \"\", expected 4 numbers"));
  EXPECT_THAT(Read(with("1.5 -2 10 255 1")).error, HasSubstr(":12: found more than 4 numbers"));
  EXPECT_THAT(Read(with("1.5 inf 10 255")).error, HasSubstr(":12: z: found \"inf\", expected a finite number"));
  std::string binary = BinaryPly();
  const float inf = std::numeric_limits<float>::infinity();
  std::memcpy(binary.data() + binary.find("end_header\n") + 11, &inf, sizeof inf);
  EXPECT_THAT(Read(binary).error, HasSubstr(": point 1: y: found inf, expected a finite number"));
}

}  // namespace
}  // namespace scancal
