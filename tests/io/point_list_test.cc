#include "io/point_list.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include "tests/io/temporary_folder.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::DoubleEq;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::vector<ScanColumn> kColumns = {{"alpha", Dimension::kAngle}, {"y", Dimension::kLength}};
constexpr double kDegree = 0.017453292519943295;

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
  folder.Write("points.csv", "1,2\n3,4\n");
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
