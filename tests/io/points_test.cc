#include "io/points.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cstring>
#include "io/scan.h"
#include "io/units.h"
#include "tests/io/scan_test.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::DoubleEq;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class PointCloudTest : public ::testing::Test {
 protected:
  void WriteCloud(const std::string& name) {
    auto cloud = CreatePointCloud(folder_.path() / name);
    ASSERT_TRUE(cloud.ok()) << cloud.error().message;
    const std::array<double, 3> first[] = {{1, 2, 3}, {0.1 + 0.2, -5, 1e-9}};
    const std::array<double, 3> second[] = {{7, 8, 9}};
    ASSERT_TRUE((*cloud)->Write(first, 0).ok());
    ASSERT_TRUE((*cloud)->Write(second, 1).ok());
    ASSERT_TRUE((*cloud)->Commit().ok());
  }
  TemporaryFolder folder_;
};

template <class Number>
Number At(const std::string& bytes, size_t offset) {
  Number number = 0;
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

TEST_F(PointCloudTest, PlyIsBinaryWithTheCountInItsHeader) {
  WriteCloud("a cloud.ply");
  const std::string ply = folder_.Read("a cloud.ply");
  const size_t body = ply.find("end_header\n") + 11;
  EXPECT_THAT(ply, StartsWith("ply\nformat binary_little_endian 1.0\ncomment x, y, z in mm"));
  EXPECT_THAT(ply.substr(0, body), HasSubstr("\nelement vertex 3\nproperty double x\nproperty double y\n"
                                             "property double z\nproperty int scan\nend_header\n"));
  constexpr size_t kRecord = 3 * 8 + 4;
  ASSERT_EQ(ply.size(), body + 3 * kRecord);
  EXPECT_EQ(At<double>(ply, body + kRecord), 0.1 + 0.2);
  EXPECT_EQ(At<double>(ply, body + kRecord + 16), 1e-9);
  EXPECT_EQ(At<double>(ply, body + 2 * kRecord), 7);
  EXPECT_EQ(At<int>(ply, body + kRecord + 24), 0);
  EXPECT_EQ(At<int>(ply, body + 2 * kRecord + 24), 1);
}

TEST_F(PointCloudTest, CsvHasRoundTripDigits) {
  WriteCloud("cloud.csv");
  EXPECT_EQ(folder_.Read("cloud.csv"), "x_mm,y_mm,z_mm,scan\n1,2,3,0\n0.30000000000000004,-5,1e-09,0\n7,8,9,1\n");
}

TEST_F(PointCloudTest, NpyIsReadByOurOwnReader) {
  WriteCloud("cloud.npy");
  ScanFormat format;
  format.path = folder_.path() / "cloud.npy";
  format.columns = {{"x", Dimension::kLength}, {"y", Dimension::kLength}, {"z", Dimension::kLength}};
  format.npy_columns = {"x", "y", "z"};
  const Scan scan = ReadAll(format);
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.columns[0], ElementsAre(1, 0.1 + 0.2, 7));
  EXPECT_THAT(scan.columns[2], ElementsAre(3, 1e-9, 9));
}

TEST_F(PointCloudTest, WithoutCommitThereIsNoFile) {
  {
    auto cloud = CreatePointCloud(folder_.path() / "cloud.ply");
    const std::array<double, 3> point[] = {{1, 2, 3}};
    ASSERT_TRUE((*cloud)->Write(point, 0).ok());
  }
  EXPECT_THAT(folder_.Names(), IsEmpty());
}

TEST_F(PointCloudTest, AnUnknownExtensionIsAnErrorThatListsThem) {
  EXPECT_THAT(CreatePointCloud(folder_.path() / "cloud.pcd").error().message,
              EndsWith("cloud.pcd: found the extension '.pcd', expected .ply, .csv or .npy"));
  EXPECT_THAT(CreatePointCloud(folder_.path() / "cloud").error().message,
              EndsWith("cloud: found the extension '', expected .ply, .csv or .npy"));
}

const std::vector<ScanColumn> kColumns = {{"alpha", Dimension::kAngle}, {"y", Dimension::kLength}};

std::string Refusal(const PointRequest& request) {
  const auto points = ReadPoints(request, kColumns);
  EXPECT_FALSE(points.ok());
  return points.ok() ? "" : points.error().message;
}

TEST(ReadPoints, TypedOnesAreSeparatedBySemicolons) {
  const auto points = ReadPoints({" 10, 50;-2e1,+6.5 ;;", {}, {}}, kColumns);
  ASSERT_TRUE(points.ok()) << points.error().message;
  EXPECT_THAT(*points, ElementsAre(ElementsAre(10 * kDegree, 50), ElementsAre(-20 * kDegree, 6.5)));
}

TEST(ReadPoints, UnitsApplyToBothKinds) {
  const TemporaryFolder folder;
  folder.Write("points.csv", "note,y_um,alpha\nfirst,5000,0.5\n\n# done\nsecond,-7000,1\n");
  const auto units = ParseUnits("m, rad");
  ASSERT_TRUE(units.ok());
  const auto points = ReadPoints({"0.25,0.125", folder.path() / "points.csv", *units}, kColumns);
  ASSERT_TRUE(points.ok()) << points.error().message;
  EXPECT_THAT(*points,
              ElementsAre(ElementsAre(0.25, 125), ElementsAre(0.5, DoubleEq(5)), ElementsAre(1, DoubleEq(-7))));
}

TEST(ReadPoints, WrongOnesAreNamed) {
  EXPECT_THAT(Refusal({"1,2;3", {}, {}}), HasSubstr("point \"3\": found 1 value, expected 2: alpha, y"));
  EXPECT_THAT(Refusal({"1,2,3", {}, {}}), HasSubstr("point \"1,2,3\": found 3 values, expected 2: alpha, y"));
  for (const char* wrong : {"1,", "1,x", "1,inf", "1,nan", "1,1e999", "1,2 3"})
    EXPECT_THAT(Refusal({wrong, {}, {}}), AllOf(HasSubstr("y: found "), HasSubstr("expected a finite number")))
        << wrong;
  EXPECT_THAT(Refusal({";", {}, {}}), HasSubstr("no points"));
}

TEST(ReadPoints, WrongFilesAreNamed) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "points.csv";
  folder.Write("points.csv", "alpha,z\n1,2\n");
  EXPECT_THAT(Refusal({"", file, {}}), AllOf(HasSubstr("points.csv:1: found the columns alpha, z"), HasSubstr("'y'")));
  folder.Write("points.csv", "1,2,5\n3,4,5\n");
  EXPECT_THAT(Refusal({"", file, {}}), HasSubstr("expected a header line"));
  folder.Write("points.csv", "alpha,y\n1,2\n3,\n");
  EXPECT_THAT(Refusal({"", file, {}}), HasSubstr("points.csv: found 1 points with a missing number"));
  folder.Write("points.csv", "alpha,y\n1,x\n");
  EXPECT_THAT(Refusal({"", file, {}}), HasSubstr("points.csv:2:3: y: found \"x\""));
  EXPECT_THAT(Refusal({"", folder.path() / "none.csv", {}}), HasSubstr("none.csv"));
}

TEST(ParseUnits, NeedsALengthAndAnAngle) {
  const auto units = ParseUnits("um,rad");
  ASSERT_TRUE(units.ok());
  EXPECT_EQ(units->length_in_mm, 0.001);
  EXPECT_EQ(units->angle_in_rad, 1);
  for (const char* wrong : {"", "mm", "deg,mm", "mm,deg,m", "inch,deg", "mm,"})
    EXPECT_THAT(ParseUnits(wrong).error().message, HasSubstr("expected a length and an angle")) << wrong;
}

}  // namespace
}  // namespace scancal
