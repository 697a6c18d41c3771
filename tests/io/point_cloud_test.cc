#include "io/point_cloud.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cstring>
#include "io/scan_reader.h"
#include "tests/io/scan_test.h"

namespace scancal {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
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
  EXPECT_THAT(ply.substr(0, body), ::testing::HasSubstr("\nelement vertex 3\nproperty double x\nproperty double y\n"
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

}  // namespace
}  // namespace scancal
