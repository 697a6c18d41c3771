// Images of heights: PNG of 16 bits, two-dimensional .npy.
#include <gmock/gmock.h>
#include <zlib.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include "tests/io/scan_test.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string BigEndian(uint32_t number) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift);
  return bytes;
}

std::string Chunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return BigEndian(static_cast<uint32_t>(data.size())) + body + BigEndian(static_cast<uint32_t>(sum));
}

// height: in the header.
std::string Png(const std::vector<std::vector<uint16_t>>& rows, uint32_t height, char bits = 16, char interlaced = 0) {
  std::string raw;
  for (const auto& row : rows) {
    raw += '\0';
    for (const uint16_t pixel : row) raw += {static_cast<char>(pixel >> 8U), static_cast<char>(pixel & 0xFFU)};
  }
  std::string packed(compressBound(raw.size()), '\0');
  uLongf size = packed.size();
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(raw.data()), raw.size());
  packed.resize(size);
  const std::string header =
      BigEndian(static_cast<uint32_t>(rows[0].size())) + BigEndian(height) + std::string{bits, 0, 0, 0, interlaced};
  return "\x89PNG\r\n\x1a\n" + Chunk("IHDR", header) + Chunk("IDAT", packed) + Chunk("IEND", "");
}

struct TiffTags {
  uint16_t bits = 16, format = 1, samples = 1, photometric = 1,
           packing = 1;  // format: 1 unsigned, 2 signed, 3 floating
  uint32_t tile = 0, next = 0;
};

// Of two rows, in one strip, little endian.
template <class Number>
std::string Tiff(const std::vector<Number>& numbers, const TiffTags& tags = {}, uint32_t height = 2) {
  const auto number = [](uint32_t value) { return std::string(reinterpret_cast<const char*>(&value), 4); };
  std::string strip(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number));
  if (tags.packing == 8) {
    std::string packed(compressBound(strip.size()), '\0');
    uLongf size = packed.size();
    compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(strip.data()),
             strip.size());
    strip = packed.substr(0, size);
  }
  const std::vector<std::pair<uint16_t, uint32_t>> fields = {
      {256, static_cast<uint32_t>(numbers.size()) / 2 / tags.samples},
      {257, height},
      {258, tags.bits},
      {259, tags.packing},
      {262, tags.photometric},
      {tags.tile ? 324 : 273, 8},
      {277, tags.samples},
      {tags.tile ? 322 : 278, tags.tile ? tags.tile : height},
      {tags.tile ? 325 : 279, static_cast<uint32_t>(strip.size())},
      {tags.tile ? 323 : 284, tags.tile ? tags.tile : 1},
      {339, tags.format}};
  std::vector<std::string> entries;
  for (const auto& [tag, value] : fields)
    entries.push_back(number(tag | 4U << 16U) + number(1) + number(value));  // type 4: LONG
  std::sort(entries.begin(), entries.end());
  std::string directory = number(static_cast<uint32_t>(entries.size())).substr(0, 2);
  for (const std::string& entry : entries) directory += entry;
  return std::string("II*\0", 4) + number(static_cast<uint32_t>(8 + strip.size())) + strip + directory +
         number(tags.next);
}

template <class Number>
std::string Npy(const std::string& type, const std::string& shape, const std::vector<Number>& numbers) {
  std::string header = "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }\n";
  std::string bytes = "\x93NUMPY\x01";
  bytes += {'\0', static_cast<char>(header.size()), '\0'};
  bytes += header;
  bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number));
  return bytes;
}

class HeightImageTest : public ScanFileTest {
 protected:
  // y = 0.5 v - 1, z = -1 + 0.25 k.
  ScanFormat Format(std::string_view contents) {
    ScanFormat format = ScanFileTest::Format("heights", contents);
    format.angle = Steps(1, 0.5);
    format.layout = WideLayout{.value = "y",
                               .across = "z",
                               .angle_column = 0,
                               .first_column = 1,
                               .start = -1,
                               .step = 0.25,
                               .scale = 0.5,
                               .offset = -1,
                               .image = true,
                               .scaled = true};
    format.invalid = 0;
    return format;
  }
  Scan Read(std::string_view contents) { return ReadAll(Format(contents)); }
};

const std::vector<std::vector<uint16_t>> kPixels = {{1000, 0, 65535}, {3, 4, 0}};

TEST_F(HeightImageTest, APixelOfAPngIsAPoint) {
  const Scan scan = Read(Png(kPixels, 2));
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan["angle"], ElementsAre(1, 1, 1.5, 1.5));
  EXPECT_THAT(scan["z"], ElementsAre(-1, -0.5, -1, -0.75));
  EXPECT_THAT(scan["y"], ElementsAre(499, 32766.5, 0.5, 1));
  EXPECT_THAT(scan["profile"], ElementsAre(1, 1, 2, 2));
  EXPECT_EQ(scan.missing, 2);
  EXPECT_FALSE(scan.heights);
  EXPECT_EQ(scan.description, "PNG, 2 rows of 3, y = 0.5 v - 1 mm, steps");
}

TEST_F(HeightImageTest, ArraysOfAnyNumbersAreTheSame) {
  const auto expected = Read(Png(kPixels, 2)).columns;
  EXPECT_EQ(Read(Npy<uint16_t>("<u2", "(2, 3)", {1000, 0, 65535, 3, 4, 0})).columns, expected);
  EXPECT_EQ(Read(Npy<int32_t>("<i4", "(2, 3)", {1000, 0, 65535, 3, 4, 0})).columns, expected);
  EXPECT_EQ(Read(Npy<float>("<f4", "(2, 3)", {1000, 0, 65535, 3, 4, std::nanf("")})).columns, expected);
  EXPECT_EQ(Read(Npy<double>("<f8", "(2, 3)", {1000, 0, 65535, 3, 4, std::nan("")})).columns, expected);
  const Scan scan = Read(Npy<int16_t>("<i2", "(2, 1)", {-1000, 8}));
  EXPECT_THAT(scan["y"], ElementsAre(-501, 3));
  EXPECT_THAT(scan.description, HasSubstr(".npy of <i2, 2 rows of 1, y = 0.5 v - 1 mm"));
}

#ifdef SCANCAL_TIFF
TEST_F(HeightImageTest, APixelOfATiffIsAPoint) {
  const std::vector<uint16_t> pixels = {1000, 0, 65535, 3, 4, 0};
  for (const uint16_t packing : {uint16_t{1}, uint16_t{8}}) {
    const Scan scan = Read(Tiff(pixels, {.packing = packing}));
    EXPECT_THAT(scan.error, IsEmpty());
    EXPECT_THAT(scan["y"], ElementsAre(499, 32766.5, 0.5, 1));
    EXPECT_THAT(scan["z"], ElementsAre(-1, -0.5, -1, -0.75));
    EXPECT_THAT(scan["angle"], ElementsAre(1, 1, 1.5, 1.5));
    EXPECT_EQ(scan.missing, 2);
    EXPECT_THAT(scan.description, HasSubstr("TIFF, 16 bits, 2 rows of 3, y = 0.5 v - 1 mm"));
  }
  EXPECT_THAT(Read(Tiff(std::vector<int16_t>{-4, 2}, {.format = 2}))["y"], ElementsAre(-3, 0));
  ScanFormat format = Format(Tiff(std::vector<float>{-0.5F, std::numeric_limits<float>::quiet_NaN()}, {32, 3}));
  format.layout->scaled = false;
  EXPECT_THAT(ReadAll(format)["y"], ElementsAre(-1.25));
}

TEST_F(HeightImageTest, OtherTiffsAreRefused) {
  const std::vector<uint16_t> pixels = {1, 2, 3, 4};
  EXPECT_THAT(Read(Tiff(std::vector<uint8_t>{1, 2}, {.bits = 8})).error,
              HasSubstr(": found an image of 8 bits, grey, expected heights: 16 bits, or 32 in floating point, grey"));
  for (const TiffTags& tags : {TiffTags{.samples = 2}, TiffTags{.photometric = 0}})
    EXPECT_THAT(Read(Tiff(pixels, tags)).error,
                HasSubstr(": found an image of 16 bits, colours, transparency or white"));
  EXPECT_THAT(Read(Tiff(pixels, {.tile = 16})).error, HasSubstr(": found an image in tiles, expected strips of rows"));
  EXPECT_THAT(Read(Tiff(pixels, {.next = 8})).error, HasSubstr(": found more than one image in it, expected one"));
}

TEST_F(HeightImageTest, LengthsInATiffAreNotTrusted) {
  const std::string tiff = Tiff(std::vector<uint16_t>{1, 2, 3, 4});
  for (size_t size = 8; size + 4 < tiff.size(); ++size)  // the place of the next image, 0, may be missing
    EXPECT_THAT(Read(tiff.substr(0, size)).error, HasSubstr(" cannot be read as TIFF: ")) << size;
  for (const uint32_t height : {9U, 90'000'000U})
    EXPECT_THAT(Read(Tiff(std::vector<uint16_t>{1, 2}, {}, height)).error,
                HasSubstr(": its strips cannot be read as TIFF: Bogus"));
  EXPECT_THAT(Read(Tiff(std::vector<uint16_t>{1, 2}, {.packing = 8}, 90'000'000)).error,
              HasSubstr(": found 90000000 rows of 1 in "));
  std::string packed = Tiff(std::vector<uint16_t>{1, 2, 3, 4}, {.packing = 8});
  packed[12] ^= 1;
  EXPECT_THAT(Read(packed).error, HasSubstr(" cannot be read as TIFF: Decoding error"));
}
#endif

TEST_F(HeightImageTest, DeclaredUnitsAndLidars) {
  ScanFormat format = Format(Png(kPixels, 2));
  format.units.length_in_mm = 1000;
  EXPECT_THAT(ReadAll(format)["y"], ElementsAre(499e3, 32766.5e3, 500, 1000));
  EXPECT_THAT(ReadAll(format)["z"], ElementsAre(-1000, -500, -1000, -750));
  format.layout->value = "range";
  format.layout->across = "bearing";
  EXPECT_THAT(ReadAll(format)["bearing"], ElementsAre(-kDegree, -0.5 * kDegree, -kDegree, -0.75 * kDegree));
  EXPECT_THAT(ReadAll(format)["range"], ElementsAre(499e3, 32766.5e3, 500, 1000));
}

TEST_F(HeightImageTest, RowsMayBeChosenAndJoinedWithAngles) {
  ScanFormat format = Format(Png({{2, 4}, {6, 8}, {10, 12}}, 3));
  format.lines = {2, 3};
  EXPECT_THAT(ReadAll(format)["y"], ElementsAre(2, 3, 4, 5));
  format.angle = Counts("Encoder");
  format.angle->file = folder_.Write("of the rows.csv", "profile,Encoder\n1,10\n2,11\n3,12\n");
  format.angle->by = "profile";
  EXPECT_THAT(ReadAll(format)["angle"], ElementsAre(5.5, 5.5, 6, 6));
  format.angle.reset();
  EXPECT_THAT(ReadAll(format).error, HasSubstr("a profile a row has no angles; add angle:"));
}

TEST_F(HeightImageTest, HeightsOfAnLjXAreAbout32768) {
  for (const std::string& contents : {Png({{32768, 0, 32770}}, 1), Npy<uint16_t>("<u2", "(1, 3)", {32768, 0, 32770})}) {
    ScanFormat format = Format(contents);
    format.kind = "lj-x";
    format.invalid.reset();
    format.layout->scale = 0.008;
    format.layout->offset = 0;
    const Scan scan = ReadAll(format);
    EXPECT_THAT(scan["y"], ElementsAre(DoubleNear(0, 1e-9), DoubleNear(0.016, 1e-9)));
    EXPECT_EQ(scan.missing, 1);
    EXPECT_TRUE(scan.heights);
    EXPECT_THAT(scan.description, HasSubstr("y = 0.008 v - 262.144 mm, Keyence LJ-X heights, 32768 is 0, 0 missing"));
  }
}

TEST_F(HeightImageTest, ManyRowsComeInBatches) {
  auto reader = ScanReader::Open(Format(Png(std::vector(1000, std::vector<uint16_t>(250, 7)), 1000)));
  ASSERT_TRUE(reader.ok()) << reader.error().message;
  ScanBatch batch;
  size_t points = 0, batches = 0;
  for (; *(*reader)->Next(&batch); ++batches) points += batch.size();
  EXPECT_EQ(points, 250'000U);
  EXPECT_GT(batches, 3U);
  EXPECT_EQ((*reader)->bytes_read(), (*reader)->bytes_total());
}

TEST_F(HeightImageTest, WhatAPixelIsMustBeDeclared) {
  ScanFormat format = Format(Png(kPixels, 2));
  format.layout->scaled = false;
  EXPECT_THAT(ReadAll(format).error, HasSubstr(": found whole numbers, expected what one is: layout: {image: ..., "
                                               "scale: ...}, in mm"));
  format.layout->scaled = true;
  format.text.where = {{"Source", "0"}};
  EXPECT_THAT(ReadAll(format).error, HasSubstr(": where: an image has no columns, expected keep: {lines: ...}"));
  format.layout.reset();
  EXPECT_THAT(ReadAll(format).error, HasSubstr(": found an image, expected what its pixels are: layout: {image: y, "));
  format = Format(Npy<double>("<f8", "(1, 2)", {5, 6}));
  format.layout->scaled = false;
  EXPECT_THAT(ReadAll(format)["y"], ElementsAre(1.5, 2));
}

TEST_F(HeightImageTest, OtherImagesAreRefused) {
  EXPECT_THAT(Read(Png(kPixels, 2, 8)).error, HasSubstr(": found an image of 8 bits, grey, expected heights: 16 bits"));
  EXPECT_THAT(Read(Png(kPixels, 2, 16, 1)).error, HasSubstr(": found an interlaced image"));
  EXPECT_THAT(Read(Npy<uint16_t>(">u2", "(1, 2)", {5, 6})).error,
              HasSubstr("found the type \"'>u2'\", expected '<f8', '<f4', '<u2', '<i2' or '<i4'"));
  EXPECT_THAT(Read(Npy<uint16_t>("<u2", "(2,)", {5, 6})).error, HasSubstr("expected (rows, columns)"));
  ScanFormat format = Format("angle,y,z\n1,2,3\n");
  format.kind = "image";
  EXPECT_THAT(ReadAll(format).error, HasSubstr(": found neither a PNG, a TIFF nor a .npy file"));
}

TEST_F(HeightImageTest, LengthsInHeadersAreNotTrusted) {
  EXPECT_THAT(Read(Png(kPixels, 90'000'000)).error, HasSubstr(": cannot be read as PNG: "));
  const std::string png = Png(kPixels, 2);
  EXPECT_THAT(Read(png.substr(0, png.size() - 20)).error, HasSubstr(": cannot be read as PNG: the file is cut off"));
  EXPECT_THAT(Read(png.substr(0, 20)).error, HasSubstr(": cannot be read as PNG: "));
  std::string damaged = png;
  damaged[png.find("IDAT") + 9] ^= 1;
  EXPECT_THAT(Read(damaged).error, HasSubstr(": cannot be read as PNG: "));
  for (const char* shape : {"(9223372036854775807, 3)", "(3, 9223372036854775807)", "(2, 4)", "(2, 0)"})
    EXPECT_THAT(Read(Npy<uint16_t>("<u2", shape, {1, 2, 3, 4, 5, 6})).error, HasSubstr("probably cut off")) << shape;
  EXPECT_THAT(Read(Npy<uint16_t>("<u2", "(0, 3)", {})).error, HasSubstr(": no points"));
}

TEST_F(HeightImageTest, InfinityIsAnErrorWithItsRow) {
  EXPECT_THAT(Read(Npy<double>("<f8", "(2, 1)", {1, -std::numeric_limits<double>::infinity()})).error,
              HasSubstr(": row 2: y: found -inf, expected a finite number"));
}

}  // namespace
}  // namespace scancal
