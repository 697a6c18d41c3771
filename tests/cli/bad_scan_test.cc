// Damaged scan files, seen from outside.
#include <algorithm>
#include <random>
#include "tests/cli/bad_input.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class BadScanTest : public BadInputTest {};

TEST_F(BadScanTest, AMissingScanIsNamed) {
  fs::rename(left_, data_ / "lefd.csv");
  ExpectRefused(left_.string() + ": no such file; did you mean 'lefd.csv'?");
}

TEST_F(BadScanTest, AnEmptyScanIsTold) {
  WriteWhole(left_, "");
  ExpectRefused(left_.string() + ": no points: the file is empty");
}

TEST_F(BadScanTest, AHeaderAloneIsNoScan) {
  WriteWhole(left_, "angle,y,z\n");
  ExpectRefused(StartsWith(left_.string() + ": no points"));
}

TEST_F(BadScanTest, AColumnThatIsNotThereIsNamed) {
  SetLine(left_, 1, "angel,y,z");
  ExpectRefused(AllOf(StartsWith(left_.string() + ":1: found the columns angel, y, z, expected also 'angle'")));
}

TEST_F(BadScanTest, AnotherColumnIsNamed) {
  SetLine(left_, 1, "angle,x,z");
  ExpectRefused(
      StartsWith(left_.string() + ":1: found the columns angle, x, z, expected also y, z; or bearing, range"));
}

TEST_F(BadScanTest, AnUnknownColumnIsIgnored) {
  const Json expected = Undamaged();
  for (const std::string& name : kNames) {
    std::vector<std::vector<double>> rows;
    for (const ScanPoint& p : ReadPoints(data_ / (name + ".csv"))) rows.push_back({p.z, 17, p.angle, p.y});
    WriteTable(data_ / (name + ".csv"), "z,intensity,angle,y", rows);
  }
  ExpectSameResult(expected, Refined(data_));
}

TEST_F(BadScanTest, TooFewFieldsAreCounted) {
  SetLine(left_, 5, "-15,226.5");
  ExpectRefused(left_.string() + ":5: found 2 cells, expected 3 (angle, y, z)");
}

TEST_F(BadScanTest, TooManyFieldsAreCounted) {
  SetLine(left_, 5, "-15,226.5,1,2");
  ExpectRefused(left_.string() + ":5: found 4 cells, expected 3 (angle, y, z)");
}

TEST_F(BadScanTest, TextIsNoNumber) {
  SetLine(left_, 5, "-15,12.3.4,0");
  ExpectRefused(left_.string() + ":5:5: y: found \"12.3.4\", expected a number");
}

TEST_F(BadScanTest, TwoDecimalSignsAreTold) {
  std::string text = ReadWhole(left_);
  std::replace(text.begin(), text.end(), ',', ';');
  WriteWhole(left_, text);
  SetLine(left_, 7, "-15;71,5;0");
  ExpectRefused(AllOf(StartsWith(left_.string()), HasSubstr("\"71,5\""), HasSubstr("text: {decimal:")));
}

TEST_F(BadScanTest, NanAndEmptyAreMissingPointsAndCounted) {
  SetLine(left_, 5, "-15,nan,0");
  SetLine(left_, 6, "-15,,0");
  SetLine(left_, 7, "-15,NaN,0");
  const Json result = Refined(data_);
  EXPECT_EQ(result["targets"][0]["missing"], 3);
  EXPECT_EQ(result["targets"][0]["points"], 797);
  EXPECT_EQ(result["targets"][1]["missing"], 0);
}

TEST_F(BadScanTest, InfinityIsAnError) {
  SetLine(left_, 7, "-15,-inf,0");
  ExpectRefused(left_.string() + ":7:5: y: found \"-inf\", expected a finite number; a missing point is nan or empty");
}

TEST_F(BadScanTest, AnOverflowIsAnError) {
  SetLine(left_, 7, "-15,1,1e400");
  ExpectRefused(left_.string() + ":7:7: z: found \"1e400\", expected a number within +-1.8e308");
}

TEST_F(BadScanTest, OneHugeNumberIsSetAside) {
  const Json expected = Undamaged();
  SetLine(left_, 7, "-15,1e300,0");
  SetLine(left_, 8, "-15,1,-1e200");
  const Json result = Refined(data_);
  EXPECT_EQ(result["targets"][0]["set_aside"], 2);
  EXPECT_NEAR(ValueOf(result, "M"), ValueOf(expected, "M"), 0.1 * UOf(expected, "M"));
  EXPECT_NEAR(ValueOf(result, "N"), ValueOf(expected, "N"), 0.1 * UOf(expected, "N"));
}

TEST_F(BadScanTest, HugeNumbersThroughoutAreImplausible) {
  std::vector<ScanPoint> points = ReadPoints(left_);
  for (ScanPoint& p : points) p.y *= 1e298;
  WritePoints(left_, points);
  ExpectRefused(AllOf(HasSubstr("left"), HasSubstr("expected less than 50 m"), HasSubstr("units")));
}

TEST_F(BadScanTest, DenormalNumbersAreNumbers) {
  const Json expected = Undamaged();
  SetLine(left_, 7, "-15,1e-310,4e-324");
  SetLine(left_, 8, "-15,1e-400,0");
  const Json result = Refined(data_);
  EXPECT_EQ(result["targets"][0]["set_aside"], 2);  // they are 0, 226 mm off the plate
  EXPECT_NEAR(ValueOf(result, "M"), ValueOf(expected, "M"), 0.1 * UOf(expected, "M"));
}

// The order of the lines is that in time: where nothing drifts it says nothing.
TEST_F(BadScanTest, AnglesNeedNotBeSorted) {
  Append(data_ / "dataset.yaml", "influences: {drift_sweep: 0, drift: 0}\n");
  const Json expected = Refined(data_);
  std::mt19937 random(1);
  for (const std::string& name : kNames) {
    auto profiles = Profiles(ReadPoints(data_ / (name + ".csv")));
    std::shuffle(profiles.begin(), profiles.end(), random);
    std::vector<ScanPoint> points;
    for (const auto& profile : profiles) points.insert(points.end(), profile.begin(), profile.end());
    WritePoints(data_ / (name + ".csv"), points);
  }
  const Json result = Refined(data_);
  for (const char* name : {"M", "N"}) {
    EXPECT_NEAR(ValueOf(result, name), ValueOf(expected, name), 1e-10 * UOf(expected, name));
    EXPECT_NEAR(UOf(result, name), UOf(expected, name), 1e-10 * UOf(expected, name));
  }
}

TEST_F(BadScanTest, RepeatedAnglesAreProfilesOfTheirOwn) {
  const Json expected = Undamaged();
  for (const std::string& name : kNames) {  // there and back again
    std::vector<ScanPoint> points = ReadPoints(data_ / (name + ".csv"));
    std::vector<ScanPoint> back(points.rbegin() + 20, points.rend());  // the turning point is one profile
    for (size_t i = 0; i < back.size(); ++i) back[i].y += 0.05 * std::sin(12.9898 * static_cast<double>(i * i % 997));
    points.insert(points.end(), back.begin(), back.end());
    WritePoints(data_ / (name + ".csv"), points);
  }
  const Outcome outcome = Refine(data_);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr(" 237 profiles"), HasSubstr(" 4740 points")));
  EXPECT_NEAR(ValueOf(Result(), "M"), ValueOf(expected, "M"), 2 * UOf(expected, "M"));
}

TEST_F(BadScanTest, CopiesOfProfilesCountOnce) {
  const Json expected = Undamaged();
  for (const std::string& name : kNames) {
    std::vector<ScanPoint> points = ReadPoints(data_ / (name + ".csv"));
    points.insert(points.end(), points.begin(), points.begin() + 400);
    WritePoints(data_ / (name + ".csv"), points);
  }
  const Outcome outcome = Refine(data_);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr(" 120 profiles"), HasSubstr("20 of its 60 profiles are copies of others")));
  EXPECT_EQ(UOf(Result(), "M"), UOf(expected, "M"));
}

TEST_F(BadScanTest, ADepthThatMarksMissingPointsIsAskedFor) {
  std::vector<ScanPoint> points = ReadPoints(left_);
  for (size_t i = 0; i < points.size(); i += 3) points[i].y = -99.9999;
  WritePoints(left_, points);
  ExpectRefused(HasSubstr("declare invalid: -99.9999"));
}

TEST_F(BadScanTest, OneScanInRadiansIsNamed) {
  std::vector<ScanPoint> points = ReadPoints(left_);
  for (ScanPoint& p : points) p.angle *= 0.017453292519943295;
  WritePoints(left_, points);
  ExpectRefused(AllOf(HasSubstr("target left"), HasSubstr("radians")));
}

TEST_F(BadScanTest, DepthTowardsTheSensorIsToldOrDeclared) {
  const Json expected = Undamaged();
  for (const std::string& name : kNames) {
    std::vector<ScanPoint> points = ReadPoints(data_ / (name + ".csv"));
    for (ScanPoint& p : points) p.y = -p.y;
    WritePoints(data_ / (name + ".csv"), points);
  }
  Replace(data_ / "dataset.yaml", "M: [110, 130], N: [395, 425], step: 1", "M: [-200, 200], N: [-800, 800], step: 10");
  Outcome outcome = Refine(data_);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("mirror image"), HasSubstr("depth: towards")));
  EXPECT_NEAR(ValueOf(Result(), "N"), -ValueOf(expected, "N"), 1e-6);
  Append(data_ / "dataset.yaml", "depth: towards\n");
  outcome = Refine(data_);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out;
  EXPECT_NEAR(ValueOf(Result(), "N"), ValueOf(expected, "N"), 1e-6);
}

TEST_F(BadScanTest, ATruncatedLastLineIsTold) {
  const std::string whole = ReadWhole(left_);
  WriteWhole(left_, whole.substr(0, whole.rfind(',')));
  ExpectRefused(AllOf(StartsWith(left_.string() + ":801: found 2 cells, expected 3"), HasSubstr("probably cut off")));
  WriteWhole(left_, whole.substr(0, whole.rfind(',') + 1) + "-");
  ExpectRefused(AllOf(StartsWith(left_.string() + ":801:"), HasSubstr(": z: found \"-\", expected a number")));
}

TEST_F(BadScanTest, CarriageReturnsAreFine) {
  const Json expected = Undamaged();
  for (const char* file : {"left.csv", "centre.csv", "right.csv", "dataset.yaml"}) {
    std::string text;
    for (const std::string& line : Lines(ReadWhole(data_ / file))) text += line + "\r\n";
    WriteWhole(data_ / file, text);
  }
  ExpectSameResult(expected, Refined(data_));
}

TEST_F(BadScanTest, AByteOrderMarkIsFine) {
  const Json expected = Undamaged();
  for (const char* file : {"left.csv", "dataset.yaml"})
    WriteWhole(data_ / file, "\xEF\xBB\xBF" + ReadWhole(data_ / file));
  ExpectSameResult(expected, Refined(data_));
}

TEST_F(BadScanTest, TheLastLineNeedsNoEnd) {
  const Json expected = Undamaged();
  for (const char* file : {"left.csv", "dataset.yaml"}) {
    std::string text = ReadWhole(data_ / file);
    text.pop_back();
    WriteWhole(data_ / file, text);
  }
  ExpectSameResult(expected, Refined(data_));
}

TEST_F(BadScanTest, AFolderIsNoScan) {
  fs::remove(left_);
  fs::create_directory(left_);
  ExpectRefused(left_.string() + ": found a folder, expected a file");
}

TEST_F(BadScanTest, AKeepThatKeepsNothingIsTold) {
  Replace(yaml_, "scan: left.csv", "scan: left.csv, keep: {angle: [30, 40]}");
  ExpectRefused(AllOf(StartsWith(left_.string()), HasSubstr("no point is left"), HasSubstr("keep")));
}

TEST_F(BadScanTest, BinaryDataAreNoText) {
  std::string bytes(3000, '\0');
  std::mt19937 random(1);
  for (char& byte : bytes) byte = static_cast<char>(random());
  WriteWhole(left_, bytes);
  ExpectRefused(AllOf(StartsWith(left_.string() + ": found binary data"), HasSubstr("expected text")));
}

TEST_F(BadScanTest, TextIsNoNpy) {
  fs::copy(left_, data_ / "left.npy");
  Replace(yaml_, "scan: left.csv", "scan: left.npy, columns: [angle, y, z]");
  ExpectRefused(StartsWith((data_ / "left.npy").string() + ": "));
}

TEST_F(BadScanTest, OneProfileMakesNoPlane) {
  WritePoints(left_, Profiles(ReadPoints(left_)).front());
  ExpectRefused(AllOf(HasSubstr("left"), HasSubstr("two angles")));
}

}  // namespace
}  // namespace scancal
