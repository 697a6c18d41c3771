// What ScanWriter writes, ScanReader reads.
#include "io/scan_writer.h"
#include <gmock/gmock.h>
#include "tests/io/scan_test.h"

namespace scancal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ScanWriterTest : public ScanFileTest {
 protected:
  const ScanBatch batch_ = {{"angle", "z", "y", "profile"},
                            {{0.1, 0.1, -1e-17}, {-1.5, 0, 1. / 3}, {70.25, 1e9, -0.5}, {1, 1, 2}}};

  Result<void> Write(const std::filesystem::path& path) {
    ScanFormat format = Format("unused", "");
    SCANCAL_ASSIGN_OR_RETURN(const auto writer, ScanWriter::Create(path, format.columns));
    for (int k = 0; k < 2; ++k) SCANCAL_RETURN_IF_ERROR(writer->Write(batch_));
    EXPECT_THAT(writer->names(), ElementsAre("angle_rad", "z_mm", "y_mm", "profile"));
    EXPECT_EQ(writer->points(), 6);
    return writer->Commit();
  }
};

TEST_F(ScanWriterTest, EveryFormatIsReadBackBitForBit) {
  for (const char* name : {"scan.csv", "scan.npy", "scan.ply", "scan.pcd"}) {
    const auto written = Write(folder_.path() / name);
    ASSERT_TRUE(written.ok()) << written.error().message;
    ScanFormat format = Format("unused", "");
    format.path = folder_.path() / name;
    format.units.length_in_mm = 1000;  // the names of the columns win
    if (std::string(name) == "scan.npy") format.npy_columns = {"angle_rad", "z_mm", "y_mm", "profile"};
    const Scan scan = ReadAll(format);
    EXPECT_THAT(scan.error, IsEmpty());
    for (size_t k = 0; k < batch_.names.size(); ++k) {
      std::vector<double> twice = batch_.columns[k];
      twice.insert(twice.end(), batch_.columns[k].begin(), batch_.columns[k].end());
      EXPECT_EQ(scan[batch_.names[k]], twice) << name << " " << batch_.names[k];
    }
  }
}

TEST_F(ScanWriterTest, OtherExtensionsAreRefused) {
  const auto written = Write(folder_.path() / "scan.xyz");
  ASSERT_FALSE(written.ok());
  EXPECT_THAT(written.error().message, HasSubstr("found the extension '.xyz', expected .csv, .npy, .ply or .pcd"));
}

TEST_F(ScanWriterTest, WithoutCommitNothingIsThere) {
  {
    const auto writer = ScanWriter::Create(folder_.path() / "scan.csv", {});
    ASSERT_TRUE(writer.ok());
    ASSERT_TRUE((*writer)->Write(batch_).ok());
  }
  EXPECT_THAT(folder_.Names(), IsEmpty());
}

}  // namespace
}  // namespace scancal
