// Text as instruments and spreadsheets write it: read as the plain file that says the same.
#include <archive.h>
#include <archive_entry.h>
#include <gmock/gmock.h>
#include <cmath>
#include "io/delimited.h"
#include "io/input_file.h"
#include "io/table.h"
#include "tests/io/scan_test.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

std::string InUtf16(const std::string& ascii, bool little, bool mark) {
  std::string bytes = mark ? (little ? "\xFF\xFE" : "\xFE\xFF") : "";
  for (const char c : ascii) bytes += little ? std::string{c, '\0'} : std::string{'\0', c};
  return bytes;
}

// The files of a .zip, or the one of a filter.
std::string Packed(const std::vector<std::pair<std::string, std::string>>& files, int (*filter)(archive*)) {
  std::string bytes(10'000'000, '\0');
  size_t used = 0;
  archive* const out = archive_write_new();
  if (filter) {
    EXPECT_EQ(filter(out), ARCHIVE_OK);
    archive_write_set_format_raw(out);
  } else {
    archive_write_set_format_zip(out);
  }
  archive_write_set_bytes_in_last_block(out, 1);
  EXPECT_EQ(archive_write_open_memory(out, bytes.data(), bytes.size(), &used), ARCHIVE_OK);
  for (const auto& [name, contents] : files) {
    archive_entry* const entry = archive_entry_new();
    archive_entry_set_pathname(entry, name.c_str());
    archive_entry_set_size(entry, static_cast<int64_t>(contents.size()));
    archive_entry_set_filetype(entry, AE_IFREG);
    archive_entry_set_perm(entry, 0644);
    archive_write_header(out, entry);
    archive_write_data(out, contents.data(), contents.size());
    archive_entry_free(entry);
  }
  archive_write_free(out);
  bytes.resize(used);
  return bytes;
}

class DialectTest : public ::testing::Test {
 protected:
  ScanFormat Format(std::string_view contents) const {
    ScanFormat format;
    format.path = folder_.Write("left scan.csv", contents);
    format.columns = {{"angle", Dimension::kAngle}, {"y", Dimension::kLength}, {"z", Dimension::kLength}};
    format.units = {.length = "mm", .angle = "rad", .length_in_mm = 1, .angle_in_rad = 1};
    return format;
  }
  // Of the columns angle, y, z, and how the file was found to be written.
  void ExpectReads(const ScanFormat& format, const std::string& dialect, int64_t missing = 0) const {
    const Scan scan = ReadAll(format);
    ASSERT_THAT(scan.error, IsEmpty());
    EXPECT_THAT(scan.names, ElementsAre("angle", "y", "z"));
    EXPECT_THAT(scan.columns, ElementsAre(ElementsAre(0.5, -0.25), ElementsAre(71.326, 1071.5), ElementsAre(-100, 3)));
    EXPECT_EQ(scan.missing, missing);
    EXPECT_EQ((*ScanReader::Open(format))->Describe(), dialect);
  }
  void ExpectReads(std::string_view contents, const std::string& dialect, int64_t missing = 0) const {
    SCOPED_TRACE(contents);
    ExpectReads(Format(contents), dialect, missing);
  }
  std::string ErrorOf(std::string_view contents) const { return ReadAll(Format(contents)).error; }

  TemporaryFolder folder_;
};

const std::string kPlain = "angle,y,z\n0.5,71.326,-100.000\n-0.25,1071.5,3\n";
const std::string kSemicolons = "angle;y;z\n0,5;71,326;-100,000\n-0,25;1071,5;3\n";

TEST_F(DialectTest, SeparatorsAndDecimalCommas) {
  ExpectReads(kPlain, "");
  ExpectReads(Replaced(kPlain, ",", ";"), "cells between semicolons");
  ExpectReads(Replaced(kPlain, ",", "\t"), "cells between tabs");
  ExpectReads(Replaced(kPlain, ",", "  "), "cells between blanks");
  ExpectReads("  " + Replaced(Replaced(kPlain, ",", "   "), "\n", " \r\n   "), "cells between blanks");
  ExpectReads(Replaced(kPlain, ",", " \t "), "cells between tabs");
  ExpectReads(kSemicolons, "cells between semicolons, decimal commas");
  ExpectReads(Replaced(kSemicolons, ";", "\t"), "cells between tabs, decimal commas");
  ExpectReads(Replaced(kSemicolons, ";", "   "), "cells between blanks, decimal commas");
  ExpectReads(Replaced(kSemicolons, "\n", "\r\n"), "cells between semicolons, decimal commas");
  ExpectReads("\xEF\xBB\xBF" + kSemicolons, "cells between semicolons, decimal commas");
}

TEST_F(DialectTest, ALongFileIsTranslatedToItsEnd) {
  std::string plain = "angle,y,z\n", german = "angle;y;z\n";
  for (int i = 0; i < 200'000; ++i) {
    const std::string row =
        std::to_string(i / 100 * 0.25) + ";" + std::to_string(70 + i * 1e-3) + ";-" + std::to_string(i % 100) + "\n";
    plain += Replaced(row, ";", ",");
    german += Replaced(row, ".", ",");
  }
  const Scan expected = ReadAll(Format(plain)), found = ReadAll(Format(german));
  EXPECT_THAT(found.error, IsEmpty());
  EXPECT_EQ(found.columns, expected.columns);
}

TEST_F(DialectTest, MetadataStandBeforeTheNames) {
  const std::string metadata = "LINE SCANNER 3000\nSerial number;4711\nDate;2026-11-02 10:15\n\nExposure;0,5;ms\n";
  ExpectReads(metadata + kSemicolons, "cells between semicolons, decimal commas, names in line 6");
  ExpectReads("# made by hand\n" + kPlain, "names in line 2");
  ExpectReads("# angle y z\n" + Replaced(kPlain.substr(10), ",", " "), "cells between blanks");  // numpy.savetxt
  ExpectReads("sep=;\n" + kSemicolons, "cells between semicolons, decimal commas, names in line 2");
}

TEST_F(DialectTest, NamesHaveUnitsAndAnyCase) {
  for (const char* names : {"Angle [rad],Y [mm],Z [mm]", "ANGLE (rad),Y(mm),z [MM]", "Angle/rad,y / mm,Z_mm",
                            "angle,y,z\nrad,mm,mm", "Angle,Y,Z\n[rad],[mm],[mm]"})
    ExpectReads(Replaced(kPlain, "angle,y,z", names),
                std::string(names).find('\n') == std::string::npos ? "" : "units in line 2");
  const Scan other = ReadAll(Format("Angle [\xC2\xB0];Y [\xC2\xB5m];Z [cm]\n180;2000;3\n"));
  EXPECT_THAT(other.columns, ElementsAre(ElementsAre(180 * kDegree), ElementsAre(2), ElementsAre(30)));
  const Scan windows = ReadAll(Format("Angle [\xB0];Y [\xB5m];Z [cm]\n180;2000;3\n"));
  EXPECT_EQ(windows.columns, other.columns);
  EXPECT_EQ((*ScanReader::Open(Format("Angle [\xB0];Y [\xB5m];Z [cm]\n180;2000;3\n")))->Describe(),
            "cells between semicolons, Windows-1252");
  ExpectReads("Angle [rad]  Y [mm]  Z [mm]\n0.5 71.326 -100\n-0.25 1071.5 3\n", "cells between blanks");
  EXPECT_THAT(ErrorOf("angle [V],y,z\n1,2,3\n"), HasSubstr("found the columns angle [V], y, z, expected also 'angle'"));
  // Where both are there, case tells them apart.
  EXPECT_THAT(ReadAll(Format("angle,y,z,X,Y,Z\n1,2,3,4,5,6\n")).columns[1], ElementsAre(2));
}

TEST_F(DialectTest, NamesMayBeMappedOrDeclared) {
  ScanFormat mapped = Format(Replaced(kPlain, "angle,y,z", "Encoder [rad],Depth,Line"));
  mapped.names = {{"angle", "Encoder"}, {"y", "Depth"}, {"z", "Line"}};
  ExpectReads(mapped, "");
  EXPECT_THAT(ErrorOf("Encoder,Depth,Line\n1,2,3\n"), HasSubstr("found the columns Encoder, Depth, Line, expected"));
  ScanFormat nameless = Format(kPlain.substr(10));
  nameless.npy_columns = {"angle", "y", "z"};
  ExpectReads(nameless, "");
  nameless.path = folder_.Write("b.txt", "Operator: A. Berg\nstart of data\n" + kSemicolons.substr(10));
  ExpectReads(nameless, "cells between semicolons, decimal commas, numbers from line 3 on");
  nameless.path = folder_.Write("c.txt", "0.5,71.326\n" + kPlain.substr(10));  // a wrong row is none of the head
  EXPECT_THAT(ReadAll(nameless).error, HasSubstr("c.txt:1: found 2 cells, expected 3"));
  EXPECT_THAT(ErrorOf(kPlain.substr(10)), HasSubstr("or columns: [angle, y, z] in the data set"));
}

TEST_F(DialectTest, WhatSpreadsheetsLeave) {
  ExpectReads("angle;y;z;\n0,5;71,326;-100;\n-0,25;1071,5;3;;\n", "cells between semicolons, decimal commas");
  ExpectReads(kPlain + kPlain.substr(0, 10), "");  // an instrument that appends writes its names again
  ExpectReads("angle,y,z\n0.5,\"71.326\",-100\n-0.25,\"1,071.50\",3\n", "commas between thousands");
  ExpectReads("angle;y;z\n0,5;71,326;-100\n-0,25;\"1.071,5\";3\n", "cells between semicolons, decimal commas");
  ExpectReads("angle,y,z\n\"0,5\",\"71,326\",-100\n\"-0,25\",\"1071,5\",3\n", "decimal commas");
  ExpectReads(Replaced(kPlain, "-", "\xE2\x88\x92"), "");
  for (const char* none : {"#N/A", "NA", "n/a", "NULL", "--", "1.#QNAN", "-nan(ind)", "-1.#IND", "NaN", ""}) {
    ExpectReads(kPlain + "1," + none + ",3\n", "", 1);
    ExpectReads(kPlain + none + ",2,3\n", "", 1);
  }
  ScanFormat declared = Format(kPlain + "1,no echo,3\n1,-99,3\n");
  declared.text.missing = {"no echo"};
  declared.invalid = -99;
  ExpectReads(declared, "", 2);
}

TEST_F(DialectTest, OnlyRowsWithAValue) {
  ScanFormat format =
      Format("Axis,Source,angle,y,z\nX,0,none,none,none\nZ,0,0.5,71.326,-100\nZ,1,9,9,9\nZ,0.0,-0.25,1071.5,3\n");
  format.text.where = {{"Axis", "Z"}, {"Source", "0"}};
  ExpectReads(format, "");
  format.text.where = {{"Axis", "Z"}, {"Source", "7"}};
  EXPECT_THAT(ReadAll(format).error,
              HasSubstr(": no points: no row is as where: {Axis: Z, Source: 7} asks; the first has \""));
  format.text.where = {{"Axes", "Z"}};
  EXPECT_THAT(ReadAll(format).error, AllOf(HasSubstr("where: found the columns"), HasSubstr("'Axes'")));
}

TEST_F(DialectTest, TwoReadingsAreRefusedWithBoth) {
  EXPECT_THAT(ErrorOf("angle,y,z\n0,5,71,326,-100,000\n"),
              AllOf(HasSubstr(":2: found 6 cells under 3 names"), HasSubstr("0.5 | 71.326 | -100.000"),
                    HasSubstr("0 | 5 | 71 | 326 | -100 | 000")));
  EXPECT_THAT(ErrorOf("angle;y;z\n0,5;71.326;1\n"),
              AllOf(HasSubstr("\"0,5\""), HasSubstr("\"71.326\""), HasSubstr("text: {decimal:")));
  EXPECT_THAT(ErrorOf("angle,y,z\n1,\"71,326\",1\n"),
              AllOf(HasSubstr("is it 71.326 or 71326?"), HasSubstr("text: {decimal:")));
  ScanFormat told = Format("angle,y,z\n0.5,\"71,326\",-100\n-0.25,\"1071,5\",3\n");
  told.text.decimal = ',';
  ExpectReads(told, "decimal commas");
}

TEST_F(DialectTest, WhatIsDeclaredHolds) {
  ScanFormat format = Format("1;2;3\nangle;y;z\n9;9;9\n0.5;71.326;-100\n-0.25;1071.5;3\n");
  format.text.header_lines = 3;
  format.text.separator = ';';
  ExpectReads(format, "cells between semicolons, names in line 2");
  format.text.decimal = ',';
  EXPECT_THAT(ReadAll(format).error,
              AllOf(HasSubstr(":4:1: angle: found \"0.5\", expected a number"), HasSubstr("decimal commas")));
  format.text.separator = '\t';
  EXPECT_THAT(ReadAll(format).error, HasSubstr("found cells between tabs"));
}

// Places are those of the file, and what was found is shown as it stands there.
TEST_F(DialectTest, ComplaintsShowTheFile) {
  EXPECT_THAT(ErrorOf(kSemicolons + "1;1.000,5,3;2\n"),
              HasSubstr("left scan.csv:4:3: y: found \"1.000,5,3\", expected a number"));
  EXPECT_THAT(ErrorOf(kSemicolons + "1;2\n"), HasSubstr(":4: found 2 cells, expected 3 (angle, y, z)"));
  EXPECT_THAT(ErrorOf(Replaced(kPlain, ",", " ") + "1 2;5 3\n"), HasSubstr(":4:3: y: found \"2;5\""));
}

TEST_F(DialectTest, EncodingsAndPackings) {
  for (const bool little : {true, false})
    for (const bool mark : {true, false}) ExpectReads(InUtf16(kPlain, little, mark), "UTF-16");
  ExpectReads(Packed({{"data", kSemicolons}}, &archive_write_add_filter_gzip),
              "gzip, cells between semicolons, decimal commas");
  ExpectReads(Packed({{"data", kPlain}}, &archive_write_add_filter_zstd), "zstd");
  ExpectReads(Packed({{"left.csv", InUtf16(kPlain, true, true)}}, nullptr), "zip, UTF-16");
  const std::string two = Packed({{"left.csv", "none"}, {"it's/right 1.csv", kPlain}}, nullptr);
  EXPECT_THAT(ErrorOf(two), HasSubstr("left scan.csv"));
  ScanFormat member = Format("");
  const std::filesystem::path zip = folder_.Write("scans.zip", two);
  member.path = zip / "it's" / "right 1.csv";
  ExpectReads(member, "zip");
  EXPECT_EQ(*Sha256(member.path), *Sha256(zip));
  member.path = zip / "none.csv";
  EXPECT_THAT(ReadAll(member).error, AllOf(HasSubstr("no file 'none.csv' in it"), HasSubstr("left.csv")));
}

TEST_F(DialectTest, DamagedPackingsAreTold) {
  const std::string sound = Packed({{"data", kPlain}}, &archive_write_add_filter_gzip);
  EXPECT_THAT(ErrorOf(sound.substr(0, sound.size() - 12)), HasSubstr("cannot be unpacked"));
  EXPECT_THAT(ErrorOf(sound.substr(0, 11)), HasSubstr("left scan.csv"));
  for (size_t k = 0; k < sound.size(); ++k) {
    std::string damaged = sound;
    damaged[k] = static_cast<char>(damaged[k] ^ 0x55);
    if (k < 4 || k > 9) {  // between them stand time and system
      EXPECT_NE(ErrorOf(damaged), "") << k;
    }
  }
  std::string long_text = "angle,y,z\n";
  while (long_text.size() < 100'000'000) long_text += "1,2,3\n1,2,3\n1,2,3\n1,2,3\n1,2,3\n1,2,3\n1,2,3\n1,2,3\n";
  EXPECT_THAT(ErrorOf(Packed({{"data", long_text}}, &archive_write_add_filter_zstd)),
              HasSubstr("grows by more than 500 times"));
}

TEST_F(DialectTest, AProfileALineInAnyDialect) {
  ScanFormat format = Format("Profiler\nangle;y0;y1\n0,5;1,5;2,5\n0,75;3,5;--\n");
  format.layout = WideLayout{.value = "y", .across = "z", .start = -1, .step = 2};
  const Scan scan = ReadAll(format);
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.columns, ElementsAre(ElementsAre(0.5, 0.5, 0.75), ElementsAre(-1, 1, -1), ElementsAre(1.5, 2.5, 3.5),
                                        ElementsAre(3, 3, 4)));
}

// As a profiler's own program exports them: a profile a column, whole numbers of 0.01 um.
TEST_F(DialectTest, AProfileAColumnInAnyDialect) {
  ScanFormat format = Format("X\tP1\tP2\n-1,5\t-2147483648\t250000\n1,5\t-2147483645\t-100000\n");
  format.layout = WideLayout{.value = "y", .across = "z", .tall = true, .scale = 1e-5};
  format.invalid = -2147483648;
  format.more_invalid = {-2147483645};
  EXPECT_THAT(ReadAll(format).error, HasSubstr("has no angles; add angle: {start:"));
  format.angle = LoggedAngle{.rad_per_count = 0.25, .is_step = true, .start = 2, .first = {}, .echo = {}};
  const Scan scan = ReadAll(format);
  EXPECT_THAT(scan.error, IsEmpty());
  EXPECT_THAT(scan.names, ElementsAre("angle", "z", "y", "profile"));
  EXPECT_THAT(scan.columns,
              ElementsAre(ElementsAre(2.25, 2.25), ElementsAre(-1.5, 1.5), ElementsAre(2.5, -1), ElementsAre(2, 2)));
  EXPECT_EQ(scan.missing, 2);
}

TEST_F(DialectTest, TablesOfTextToo) {
  const auto table = Table::Read(folder_.Write("balls.csv", "robot: R1\nPose;Ball;X [m]\nA 1;\"b;1,5\";0,25\n"),
                                 {{"pose"}, {"ball"}, {"x", Cells::kNumber, Dimension::kLength}}, {});
  ASSERT_TRUE(table.ok()) << table.error().message;
  EXPECT_EQ(table->Text("pose", 0), "A 1");
  EXPECT_EQ(table->Text("ball", 0), "b;1,5");
  EXPECT_EQ(table->Number("x", 0), 250);
}

}  // namespace
}  // namespace scancal
