// Scans as arrays of numpy.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zlib.h>
#include <cmath>
#include <cstring>
#include <limits>
#include <thread>
#include "io/units.h"
#include "tests/io/scan_test.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

template <class Float>
std::string Bytes(const std::vector<Float>& values) {
  std::string bytes(values.size() * sizeof(Float), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

// What numpy.save writes in front of the numbers; version 2 and 3 have four bytes of length.
std::string Header(const std::string& dictionary, char version = 1) {
  std::string header = "\x93NUMPY";
  header += {version, '\0', static_cast<char>(dictionary.size() + 1), '\0'};
  if (version > 1) header += {'\0', '\0'};
  return header + dictionary + '\n';
}

std::string Dictionary(const std::string& type, const std::string& shape, const std::string& order = "False") {
  return "{'descr': " + type + ", 'fortran_order': " + order + ", 'shape': " + shape + ", }      ";
}

std::string Gzip(const std::string& bytes) {
  z_stream stream = {};
  deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 9, Z_DEFAULT_STRATEGY);
  std::string packed(bytes.size() + 1000, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

class ScanNpyTest : public ::testing::Test {
 protected:
  ScanFormat Format(std::string_view contents) {
    ScanFormat format;
    format.path = folder_.Write("right scan.NPY", contents);
    format.columns = {{"angle", Dimension::kAngle}, {"y", Dimension::kLength}, {"z", Dimension::kLength}};
    format.npy_columns = {"angle", "y", "z"};
    return format;
  }
  Scan Read(std::string_view contents) { return ReadAll(Format(contents)); }
  std::string Place(const std::string& place) { return (folder_.path() / "right scan.NPY").string() + place; }

  const std::string doubles_ = Header(Dictionary("'<f8'", "(2, 3)")) + Bytes<double>({180, 2, 3, -90, 5, 6});
  TemporaryFolder folder_;
};

TEST_F(ScanNpyTest, ReadsFloat64) {
  const Scan scan = Read(doubles_);
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.names, ElementsAre("angle", "y", "z"));
  EXPECT_THAT(scan.columns[0], ElementsAre(180 * kDegree, -90 * kDegree));
  EXPECT_THAT(scan.columns[1], ElementsAre(2, 5));
  EXPECT_THAT(scan.columns[2], ElementsAre(3, 6));
}

TEST_F(ScanNpyTest, ReadsFloat32AndOtherVersionsOfTheHeader) {
  for (const char version : {'\x01', '\x02', '\x03'}) {
    const Scan scan = Read(Header(Dictionary("'<f4'", "(1, 3)"), version) + Bytes<float>({180, 0.1F, 3}));
    EXPECT_THAT(scan.error, IsEmpty());
    EXPECT_THAT(scan.columns[1], ElementsAre(static_cast<double>(0.1F)));
  }
}

TEST_F(ScanNpyTest, DeclaredColumnsMayBeInAnyOrderWithUnitsAndOthers) {
  ScanFormat format = Format(Header(Dictionary("'<f8'", "(1, 4)")) + Bytes<double>({1, 2, 3, 4}));
  format.npy_columns = {"intensity", "z", "y_m", "angle_rad"};
  const Scan scan = ReadAll(format);
  EXPECT_THAT(scan.names, ElementsAre("angle", "y", "z"));
  EXPECT_THAT(scan.columns[0], ElementsAre(4));
  EXPECT_THAT(scan.columns[1], ElementsAre(3000));
  EXPECT_THAT(scan.columns[2], ElementsAre(2));
}

TEST_F(ScanNpyTest, NanAndInvalidAreMissingPoints) {
  const auto nan = std::numeric_limits<float>::quiet_NaN();
  ScanFormat format = Format(Header(Dictionary("'<f4'", "(3, 3)")) + Bytes<float>({1, nan, 3, 1, 2, 0.1F, 1, 7, 3}));
  format.invalid = 0.1;  // stands in the file as float32
  const Scan scan = ReadAll(format);
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.columns[1], ElementsAre(7));
  EXPECT_EQ(scan.missing, 2);
}

TEST_F(ScanNpyTest, KeepsOnlyTheWantedRows) {
  ScanFormat format = Format(Header(Dictionary("'<f8'", "(4, 1)")) + Bytes<double>({1, 2, 3, 4}));
  format.columns = {{"y", Dimension::kLength}};
  format.npy_columns = {"y"};
  format.lines = {2, 3};
  EXPECT_THAT(ReadAll(format).columns[0], ElementsAre(2, 3));
  format.lines = {5, 9};
  EXPECT_EQ(ReadAll(format).error, Place(": no points in the lines 5 to 9"));
}

TEST_F(ScanNpyTest, LargeArraysComeInBatchesAndTellTheirProgress) {
  constexpr size_t kPoints = 250'000;
  const std::string contents =
      Header(Dictionary("'<f8'", "(250000, 3)")) + Bytes(std::vector<double>(3 * kPoints, 1.5));
  auto reader = ScanReader::Open(Format(contents));
  ASSERT_TRUE(reader.ok()) << reader.error().message;
  ScanBatch batch;
  size_t points = 0, batches = 0;
  for (; *(*reader)->Next(&batch); ++batches) points += batch.size();
  EXPECT_EQ(points, kPoints);
  EXPECT_GT(batches, 3U);
  EXPECT_EQ((*reader)->bytes_total(), static_cast<int64_t>(contents.size()));
  EXPECT_EQ((*reader)->bytes_read(), (*reader)->bytes_total());
}

TEST_F(ScanNpyTest, APipeIsRead) {
  ScanFormat format = Format("");
  format.path = folder_.path() / "pipe.npy";
  format.lines = {2, 4};
  ASSERT_EQ(::mkfifo(format.path.c_str(), 0600), 0);
  const std::string contents = Header(Dictionary("'<f8'", "(3, 3)")) + Bytes<double>({1, 2, 3, 4, 5, 6, 7, 8, 9});
  std::thread writer([&] { folder_.Write("pipe.npy", contents); });
  EXPECT_THAT(ReadAll(format).columns[1], ElementsAre(5, 8));
  writer.join();
  writer = std::thread([&] { folder_.Write("pipe.npy", contents.substr(0, contents.size() - 8)); });
  EXPECT_THAT(ReadAll(format).error,
              HasSubstr("found the end after row 2, expected 3 rows: the pipe was closed early"));
  writer.join();
}

TEST_F(ScanNpyTest, InfinityIsAnErrorWithItsRow) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(Read(Header(Dictionary("'<f8'", "(2, 3)")) + Bytes<double>({1, 2, 3, 1, 2, -inf})).error,
            Place(": row 2: z: found -inf, expected a finite number; a missing point is nan or empty"));
}

TEST_F(ScanNpyTest, TruncatedNumbersAreAnError) {
  EXPECT_EQ(Read(doubles_.substr(0, doubles_.size() - 1)).error,
            Place(": found 47 bytes of numbers, expected 2 rows of 24 bytes; the file is probably cut off"));
  EXPECT_THAT(Read(Header(Dictionary("'<f8'", "(9223372036854775807, 3)"))).error, HasSubstr("probably cut off"));
}

TEST_F(ScanNpyTest, BytesBehindTheArrayAreAnError) {
  EXPECT_THAT(Read(doubles_ + doubles_).error, HasSubstr("the file is followed by something else"));
}

TEST_F(ScanNpyTest, ATruncatedHeaderIsAnError) {
  EXPECT_EQ(Read(doubles_.substr(0, 40)).error, Place(": the file is cut off in its header"));
}

TEST_F(ScanNpyTest, AnotherFormatIsAnError) {
  EXPECT_EQ(Read("angle,y,z\n1,2,3\n").error, Place(": found other data, expected a .npy array"));
  EXPECT_EQ(Read("").error, Place(": found an empty file, expected a .npy array"));
}

TEST_F(ScanNpyTest, AnUnknownVersionIsAnError) {
  EXPECT_EQ(Read(Header(Dictionary("'<f8'", "(2, 3)"), '\x04')).error,
            Place(": found version 4 of the .npy format, expected 1, 2 or 3"));
}

TEST_F(ScanNpyTest, AnotherTypeIsAnError) {
  EXPECT_EQ(Read(Header(Dictionary("'>f8'", "(2, 3)"))).error,
            Place(": found the type \"'>f8'\", expected '<f8' or '<f4'; save array.astype('<f8')"));
  EXPECT_THAT(Read(Header(Dictionary("[('y', '<f8'), ('z', '<f8')]", "(2,)"))).error,
              HasSubstr("found the type \"[('y', '<f8'), ('z', '<f8')]\""));
}

TEST_F(ScanNpyTest, FortranOrderIsAnError) {
  EXPECT_EQ(Read(Header(Dictionary("'<f8'", "(2, 3)", "True"))).error,
            Place(": found fortran_order: \"True\", expected False; save numpy.ascontiguousarray(array)"));
}

TEST_F(ScanNpyTest, AnotherShapeIsAnError) {
  for (const std::string shape : {"(6,)", "()", "(1, 2, 3)", "(-1, 3)", "(a, 3)"}) {
    EXPECT_EQ(Read(Header(Dictionary("'<f8'", shape))).error,
              Place(": found the shape \"" + shape + "\", expected (points, columns)"));
  }
  EXPECT_EQ(Read(Header(Dictionary("'<f8'", "(3, 2)")) + Bytes<double>({1, 2, 3, 4, 5, 6})).error,
            Place(": found the shape (3, 2), expected (points, 3) as declared by columns: [angle, y, z]"));
}

TEST_F(ScanNpyTest, PackedOrThroughAPipeOfAnyName) {
  for (const std::string& contents : {doubles_, Gzip(doubles_)})
    for (const bool piped : {false, true}) {
      ScanFormat format = Format("");
      format.path = folder_.path() / (piped ? "stdin" : "packed");
      std::filesystem::remove(format.path);
      const int made = piped ? ::mkfifo(format.path.c_str(), 0600) : 0;
      ASSERT_EQ(made, 0);
      std::thread writer([&] { folder_.Write(format.path.filename(), contents); });
      if (!piped) writer.join();
      format.lines = {2, 9};
      const Scan scan = ReadAll(format);
      if (piped) writer.join();
      EXPECT_THAT(scan.error, IsEmpty());
      EXPECT_THAT(scan["y"], ElementsAre(5));
      EXPECT_EQ(scan.description, contents == doubles_ ? "" : "gzip");
    }
  EXPECT_THAT(
      Read(Gzip(doubles_.substr(0, doubles_.size() - 8))).error,
      HasSubstr("found the end after row 1, expected 2 rows: the file was probably cut off before it was packed"));
  EXPECT_THAT(Read(Gzip(Header(Dictionary("'<f8'", "(9, 9000000000000)")))).error, HasSubstr("expected (points, 3)"));
}

TEST_F(ScanNpyTest, ArraysWithoutRowsHaveNoPoints) {
  EXPECT_THAT(Read(Header(Dictionary("'<f8'", "(0, 3)"))).error, HasSubstr(": no points"));
}

TEST_F(ScanNpyTest, UndeclaredColumnsAreAnError) {
  ScanFormat format = Format(doubles_);
  format.npy_columns.clear();
  EXPECT_THAT(ReadAll(format).error, AllOf(HasSubstr(Place(": ")), HasSubstr("add columns: [angle, y, z]")));
}

TEST_F(ScanNpyTest, AMissingColumnIsAnError) {
  ScanFormat format = Format(doubles_);
  format.npy_columns = {"angle", "x", "z"};
  EXPECT_EQ(ReadAll(format).error,
            Place(": columns: found the columns angle, x, z, expected also 'y' (or y_mm, _m, _um)"));
}

TEST_F(ScanNpyTest, AMissingFileAndAFolderAreErrors) {
  ScanFormat format = Format(doubles_);
  format.path = folder_.path() / "absent.npy";
  EXPECT_EQ(ReadAll(format).error, format.path.string() + ": no such file");
  std::filesystem::create_directory(format.path);
  EXPECT_EQ(ReadAll(format).error, format.path.string() + ": found a folder, expected a file");
}

}  // namespace
}  // namespace scancal
