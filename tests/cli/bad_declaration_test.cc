// Damaged declarations, seen from outside: dataset.yaml and its units.
#include <sys/stat.h>
#include "io/units.h"
#include "tests/cli/bad_input.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class BadDeclarationTest : public BadInputTest {};

TEST_F(BadDeclarationTest, AMissingDataSetIsNamed) {
  fs::remove(yaml_);
  ExpectRefused(yaml_.string() + ": no such file");
}

TEST_F(BadDeclarationTest, AnEmptyDataSetIsTold) {
  WriteWhole(yaml_, "");
  ExpectRefused(StartsWith(yaml_.string() + ": the file is empty, expected"));
}

TEST_F(BadDeclarationTest, AnUnknownKeyIsRefusedWithTheNearestOne) {
  Append(yaml_, "rotaton: clockwise\n");
  ExpectRefused(yaml_.string() + ":11:1: unknown key 'rotaton', did you mean 'rotation'?");
}

TEST_F(BadDeclarationTest, AKeyOfATargetIsChecked) {
  Replace(yaml_, "scan: left.csv", "scan: left.csv, kep: {angle: [-1, 1]}");
  ExpectRefused(AllOf(StartsWith(yaml_.string() + ":8:"), HasSubstr("'kep'"), HasSubstr("did you mean 'keep'?")));
}

TEST_F(BadDeclarationTest, AFolderIsNoDataSetFile) {
  fs::remove(yaml_);
  fs::create_directory(yaml_);
  ExpectRefused(yaml_.string() + ": found a folder, expected a file");
}

TEST_F(BadDeclarationTest, NamesOfTargetsAreDifferent) {
  Replace(yaml_, "name: right", "name: left");
  ExpectRefused(AllOf(StartsWith(yaml_.string() + ":10:"), HasSubstr("name: found \"left\""), HasSubstr("no other")));
}

TEST_F(BadDeclarationTest, UncertaintiesAreNotNegative) {
  Append(yaml_, "parameters: {tilt_x: {consider: 0, u: -0.1}}\n");
  ExpectRefused(AllOf(StartsWith(yaml_.string() + ":11:"), HasSubstr("tilt_x: u: found \"-0.1\", expected")));
}

TEST_F(BadDeclarationTest, InfluencesAreNotNegative) {
  Append(yaml_, "influences: {noise_y: -1}\n");
  ExpectRefused(AllOf(StartsWith(yaml_.string() + ":11:"), HasSubstr("noise_y: found \"-1\", expected")));
}

TEST_F(BadDeclarationTest, AnIntervalUpsideDownIsRefused) {
  Replace(yaml_, "[110, 130]", "[130, 110]");
  ExpectRefused(
      AllOf(StartsWith(yaml_.string() + ":6:"), HasSubstr("search: M: found [130, 110], expected the lower")));
}

TEST_F(BadDeclarationTest, AKeepIntervalUpsideDownIsRefused) {
  Replace(yaml_, "scan: left.csv", "scan: left.csv, keep: {angle: [5, -5]}");
  ExpectRefused(AllOf(StartsWith(yaml_.string() + ":8:"), HasSubstr("keep: angle: found [5, -5], expected the lower")));
}

TEST_F(BadDeclarationTest, DegreesDeclaredAsRadians) {
  Replace(yaml_, "angle: deg", "angle: rad");
  ExpectRefused(AllOf(HasSubstr("left"), HasSubstr("span 30 rad"), HasSubstr("degrees declared as rad")));
}

TEST_F(BadDeclarationTest, RadiansDeclaredAsDegrees) {
  ScaleColumns(kDegree, 1);
  ExpectRefused(AllOf(HasSubstr("span 0.524 deg"), HasSubstr("declare angle: rad")));
}

TEST_F(BadDeclarationTest, MillimetresDeclaredAsMetres) {
  Replace(yaml_, "length: mm", "length: m");
  ExpectRefused(
      AllOf(StartsWith(yaml_.string() + ":6:"), HasSubstr("search: M"), HasSubstr("is units: length: right?")));
  Replace(yaml_, "search: {M: [110, 130], N: [395, 425], step: 1}",
          "search: {M: [0.11, 0.13], N: [0.395, 0.425], step: 0.001}");
  ExpectRefused(AllOf(HasSubstr("left"), HasSubstr("mm declared as m")));
}

TEST_F(BadDeclarationTest, MetresDeclaredAsMillimetres) {
  ScaleColumns(1, 0.001);
  ExpectRefused(AllOf(HasSubstr("0.2267 mm"), HasSubstr("m declared as mm")));
}

TEST_F(BadDeclarationTest, MillimetresDeclaredAsMicrometres) {
  Replace(yaml_, "length: mm", "length: um");
  ExpectRefused(AllOf(HasSubstr("0.2267 mm"), HasSubstr("um")));
}

TEST_F(BadDeclarationTest, AnotherModelIsUnknown) {
  Replace(yaml_, "model: turntable", "model: turntabel");
  ExpectRefused(AllOf(StartsWith(yaml_.string() + ":2:8: model: found \"turntabel\", expected"),
                      HasSubstr("expected one of: turntable, robot-ball")));
}

TEST_F(BadDeclarationTest, AbsurdFiguresAreRefused) {
  const std::string text = ReadWhole(yaml_);
  for (const auto& [line, sentence] :
       {std::pair{"influences: {scale_y: 1e30}", "scale_y: found \"1e30\", expected a standard uncertainty"},
        {"influences: {scale_y: 2}", "scale_y: found a standard uncertainty of 2 of the whole, expected at most 1"},
        {"influences: {flatness: 1e6}", "flatness: found a standard uncertainty"},
        {"influences: {encoder_cos1: 400}", "encoder_cos1: found a standard uncertainty"},
        {"influences: {temperature: 5, expansion: 3}", "found a standard uncertainty of 15 of the whole"},
        {"parameters: {M: {estimate: 120, u: 1e5}}", "M: found a standard uncertainty of 1e+05 mm"},
        {"parameters: {tilt_x: {consider: 0, u: 1e300}}", "u: found \"1e300\", expected"}}) {
    WriteWhole(yaml_, text + line + "\n");
    ExpectRefused(HasSubstr(sentence));
  }
}

TEST_F(BadDeclarationTest, APriorWithoutUncertaintyIsNone) {
  Append(yaml_, "parameters: {tilt_x: {estimate: 0, u: 0}}\n");
  ExpectRefused(HasSubstr("u: found \"0\", expected more than 0; without a prior it is tilt_x: estimate"));
}

TEST_F(BadDeclarationTest, AMillionTargetsAreRefusedAtOnce) {
  std::string text = ReadWhole(yaml_);
  for (int k = 0; k < 20'000; ++k) text += "  - {name: t" + std::to_string(k) + ", scan: left.csv}\n";
  WriteWhole(yaml_, text);
  ExpectRefused(HasSubstr("targets: found 20003 items, expected at most 1000"));
  text.append(5'000'000, '#');
  WriteWhole(yaml_, text);
  ExpectRefused(HasSubstr("found more than 4 MB, expected a small file"));
}

// Otherwise a data set could show what only this program may read.
TEST_F(BadDeclarationTest, WhatIsNoScanIsNotShown) {
  WriteWhole(data_ / "left.csv", "root:$6$Xyz12345:19000:0:99999:7:::\nangle\n");
  const Outcome outcome = Refine(data_);
  EXPECT_THAT(OneSentence(outcome), AllOf(HasSubstr("left.csv"), ::testing::Not(HasSubstr("Xyz"))));
  WriteWhole(yaml_, "hunter2 secret\n");
  EXPECT_THAT(OneSentence(Refine(data_)), ::testing::Not(HasSubstr("hunter2")));
}

TEST_F(BadDeclarationTest, PipesAndDevicesDoNotHang) {
  fs::remove(data_ / "left.csv");
  ASSERT_EQ(::mkfifo((data_ / "left.csv").c_str(), 0600), 0);
  ExpectRefused(HasSubstr("left.csv: found a pipe into which nobody writes, expected a file"));
  Replace(yaml_, "left.csv", "/dev/zero");
  ExpectRefused("/dev/zero: found a device, expected a file");
}

TEST_F(BadDeclarationTest, TwoProfilesAreNoPlacement) {
  std::vector<std::string> lines = Lines(ReadWhole(data_ / "right.csv"));
  std::string kept = lines[0] + "\n";
  for (size_t k = 1; k < lines.size(); ++k)
    if (k <= 20 || k > lines.size() - 20) kept += lines[k] + "\n";
  WriteWhole(data_ / "right.csv", kept);
  const Outcome outcome = Refine(data_);
  EXPECT_EQ(outcome.exit_code, 2) << ::testing::PrintToString(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("target right: 2 profiles fit nearly any plane"));
}

}  // namespace
}  // namespace scancal
