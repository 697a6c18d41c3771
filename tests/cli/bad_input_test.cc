// Damaged data sets, seen from outside: exit code 1, one sentence with the place, and the old result untouched.
#include <gmock/gmock.h>
#include <algorithm>
#include <numbers>
#include <random>
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Matcher;
using ::testing::StartsWith;

class BadInputTest : public CliTest {
 protected:
  BadInputTest() {
    fs::create_directories(Path("out"));
    WriteWhole(Path("out") / "calibration.json", kOld);
  }

  void ExpectRefused(const Matcher<std::string>& sentence) const {
    const Outcome outcome = Refine(data_);
    EXPECT_EQ(outcome.exit_code, 1) << ::testing::PrintToString(outcome);
    EXPECT_THAT(OneSentence(outcome), sentence);
    std::vector<std::string> left;
    for (const auto& entry : fs::directory_iterator(Path("out"))) left.push_back(entry.path().filename());
    EXPECT_THAT(left, ElementsAre("calibration.json"));
    EXPECT_EQ(ReadWhole(Path("out") / "calibration.json"), kOld);
  }

  // What the data set says without damage; refines it into `out`, which is then the old result again.
  Json Undamaged() const {
    const Json result = Refined(MakeData("undamaged"));
    WriteWhole(Path("out") / "calibration.json", kOld);
    return result;
  }
  void ExpectSameResult(const Json& expected, const Json& found) const {
    for (const char* name : {"M", "N"}) {
      EXPECT_NEAR(ValueOf(found, name), ValueOf(expected, name), 1e-10 * UOf(expected, name));
      EXPECT_NEAR(UOf(found, name), UOf(expected, name), 1e-10 * UOf(expected, name));
    }
  }
  void ScaleColumns(double angle, double length) const {
    for (const std::string& name : kNames) {
      std::vector<ScanPoint> points = ReadPoints(data_ / (name + ".csv"));
      for (ScanPoint& p : points) p = {p.angle * angle, p.y * length, p.z * length};
      WritePoints(data_ / (name + ".csv"), points);
    }
  }

  const std::string kOld = "the old result";
  const fs::path data_ = MakeData();
  const fs::path left_ = data_ / "left.csv", yaml_ = data_ / "dataset.yaml";
};

TEST_F(BadInputTest, AMissingScanIsNamed) {
  fs::rename(left_, data_ / "lefd.csv");
  ExpectRefused(left_.string() + ": no such file; did you mean 'lefd.csv'?");
}

TEST_F(BadInputTest, AMissingDataSetIsNamed) {
  fs::remove(yaml_);
  ExpectRefused(yaml_.string() + ": no such file");
}

TEST_F(BadInputTest, AnEmptyScanIsTold) {
  WriteWhole(left_, "");
  ExpectRefused(left_.string() + ": no points: the file is empty");
}

TEST_F(BadInputTest, AnEmptyDataSetIsTold) {
  WriteWhole(yaml_, "");
  ExpectRefused(StartsWith(yaml_.string() + ": the file is empty, expected"));
}

TEST_F(BadInputTest, AHeaderAloneIsNoScan) {
  WriteWhole(left_, "angle,y,z\n");
  ExpectRefused(StartsWith(left_.string() + ": no points"));
}

TEST_F(BadInputTest, AnUnknownKeyIsRefusedWithTheNearestOne) {
  Append(yaml_, "rotaton: clockwise\n");
  ExpectRefused(yaml_.string() + ":11:1: unknown key 'rotaton', did you mean 'rotation'?");
}

TEST_F(BadInputTest, AKeyOfATargetIsChecked) {
  Replace(yaml_, "scan: left.csv", "scan: left.csv, kep: {angle: [-1, 1]}");
  ExpectRefused(AllOf(StartsWith(yaml_.string() + ":8:"), HasSubstr("'kep'"), HasSubstr("did you mean 'keep'?")));
}

TEST_F(BadInputTest, AColumnThatIsNotThereIsNamed) {
  SetLine(left_, 1, "angel,y,z");
  ExpectRefused(AllOf(StartsWith(left_.string() + ":1: found the columns angel, y, z, expected also 'angle'")));
}

TEST_F(BadInputTest, AColumnInCapitalsIsUnknown) {
  SetLine(left_, 1, "angle,Y,z");
  ExpectRefused(AllOf(StartsWith(left_.string() + ":"), HasSubstr("found only angle, z; expected angle with y and z"),
                      HasSubstr("lower case")));
}

TEST_F(BadInputTest, AnUnknownColumnIsIgnored) {
  const Json expected = Undamaged();
  for (const std::string& name : kNames) {
    std::vector<std::vector<double>> rows;
    for (const ScanPoint& p : ReadPoints(data_ / (name + ".csv"))) rows.push_back({p.z, 17, p.angle, p.y});
    WriteTable(data_ / (name + ".csv"), "z,intensity,angle,y", rows);
  }
  ExpectSameResult(expected, Refined(data_));
}

TEST_F(BadInputTest, TooFewFieldsAreCounted) {
  SetLine(left_, 5, "-15,226.5");
  ExpectRefused(left_.string() + ":5: found 2 cells, expected 3 (angle, y, z)");
}

TEST_F(BadInputTest, TooManyFieldsAreCounted) {
  SetLine(left_, 5, "-15,226.5,1,2");
  ExpectRefused(left_.string() + ":5: found 4 cells, expected 3 (angle, y, z)");
}

TEST_F(BadInputTest, TextIsNoNumber) {
  SetLine(left_, 5, "-15,12.3.4,0");
  ExpectRefused(left_.string() + ":5:5: y: found \"12.3.4\", expected a number");
}

TEST_F(BadInputTest, SemicolonsAreTold) {
  std::string text = ReadWhole(left_);
  std::replace(text.begin(), text.end(), ',', ';');
  WriteWhole(left_, text);
  ExpectRefused(AllOf(StartsWith(left_.string() + ":1: "), HasSubstr("semicolons, expected commas")));
}

TEST_F(BadInputTest, NanAndEmptyAreMissingPointsAndCounted) {
  SetLine(left_, 5, "-15,nan,0");
  SetLine(left_, 6, "-15,,0");
  SetLine(left_, 7, "-15,NaN,0");
  const Json result = Refined(data_);
  EXPECT_EQ(result["targets"][0]["missing"], 3);
  EXPECT_EQ(result["targets"][0]["points"], 797);
  EXPECT_EQ(result["targets"][1]["missing"], 0);
}

TEST_F(BadInputTest, InfinityIsAnError) {
  SetLine(left_, 7, "-15,-inf,0");
  ExpectRefused(left_.string() + ":7:5: y: found \"-inf\", expected a finite number; a missing point is nan or empty");
}

TEST_F(BadInputTest, AnOverflowIsAnError) {
  SetLine(left_, 7, "-15,1,1e400");
  ExpectRefused(left_.string() + ":7:7: z: found \"1e400\", expected a number within +-1.8e308");
}

TEST_F(BadInputTest, OneHugeNumberIsSetAside) {
  const Json expected = Undamaged();
  SetLine(left_, 7, "-15,1e300,0");
  SetLine(left_, 8, "-15,1,-1e200");
  const Json result = Refined(data_);
  EXPECT_EQ(result["targets"][0]["set_aside"], 2);
  EXPECT_NEAR(ValueOf(result, "M"), ValueOf(expected, "M"), 0.1 * UOf(expected, "M"));
  EXPECT_NEAR(ValueOf(result, "N"), ValueOf(expected, "N"), 0.1 * UOf(expected, "N"));
}

TEST_F(BadInputTest, HugeNumbersThroughoutAreImplausible) {
  std::vector<ScanPoint> points = ReadPoints(left_);
  for (ScanPoint& p : points) p.y *= 1e298;
  WritePoints(left_, points);
  ExpectRefused(AllOf(HasSubstr("left"), HasSubstr("expected less than 50 m"), HasSubstr("units")));
}

TEST_F(BadInputTest, DenormalNumbersAreNumbers) {
  const Json expected = Undamaged();
  SetLine(left_, 7, "-15,1e-310,4e-324");
  SetLine(left_, 8, "-15,1e-400,0");
  const Json result = Refined(data_);
  EXPECT_EQ(result["targets"][0]["set_aside"], 2);  // they are 0, 226 mm off the plate
  EXPECT_NEAR(ValueOf(result, "M"), ValueOf(expected, "M"), 0.1 * UOf(expected, "M"));
}

TEST_F(BadInputTest, AnglesNeedNotBeSorted) {
  const Json expected = Undamaged();
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

TEST_F(BadInputTest, RepeatedAnglesAreProfilesOfTheirOwn) {
  const Json expected = Undamaged();
  for (const std::string& name : kNames) {  // there and back again
    std::vector<ScanPoint> points = ReadPoints(data_ / (name + ".csv"));
    const std::vector<ScanPoint> back(points.rbegin() + 20, points.rend());  // the turning point is one profile
    points.insert(points.end(), back.begin(), back.end());
    WritePoints(data_ / (name + ".csv"), points);
  }
  const Outcome outcome = Refine(data_);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr(" 237 profiles"), HasSubstr(" 4740 points")));
  EXPECT_NEAR(ValueOf(Result(), "M"), ValueOf(expected, "M"), 0.2 * UOf(expected, "M"));
}

TEST_F(BadInputTest, ATruncatedLastLineIsTold) {
  const std::string whole = ReadWhole(left_);
  WriteWhole(left_, whole.substr(0, whole.rfind(',')));
  ExpectRefused(AllOf(StartsWith(left_.string() + ":801: found 2 cells, expected 3"), HasSubstr("probably cut off")));
  WriteWhole(left_, whole.substr(0, whole.rfind(',') + 1) + "-");
  ExpectRefused(AllOf(StartsWith(left_.string() + ":801:"), HasSubstr(": z: found \"-\", expected a number")));
}

TEST_F(BadInputTest, CarriageReturnsAreFine) {
  const Json expected = Undamaged();
  for (const char* file : {"left.csv", "centre.csv", "right.csv", "dataset.yaml"}) {
    std::string text;
    for (const std::string& line : Lines(ReadWhole(data_ / file))) text += line + "\r\n";
    WriteWhole(data_ / file, text);
  }
  ExpectSameResult(expected, Refined(data_));
}

TEST_F(BadInputTest, AByteOrderMarkIsFine) {
  const Json expected = Undamaged();
  for (const char* file : {"left.csv", "dataset.yaml"})
    WriteWhole(data_ / file, "\xEF\xBB\xBF" + ReadWhole(data_ / file));
  ExpectSameResult(expected, Refined(data_));
}

TEST_F(BadInputTest, TheLastLineNeedsNoEnd) {
  const Json expected = Undamaged();
  for (const char* file : {"left.csv", "dataset.yaml"}) {
    std::string text = ReadWhole(data_ / file);
    text.pop_back();
    WriteWhole(data_ / file, text);
  }
  ExpectSameResult(expected, Refined(data_));
}

TEST_F(BadInputTest, AFolderIsNoScan) {
  fs::remove(left_);
  fs::create_directory(left_);
  ExpectRefused(left_.string() + ": found a folder, expected a file");
}

TEST_F(BadInputTest, AFolderIsNoDataSetFile) {
  fs::remove(yaml_);
  fs::create_directory(yaml_);
  ExpectRefused(yaml_.string() + ": found a folder, expected a file");
}

TEST_F(BadInputTest, NamesOfTargetsAreDifferent) {
  Replace(yaml_, "name: right", "name: left");
  ExpectRefused(AllOf(StartsWith(yaml_.string() + ":10:"), HasSubstr("name: found \"left\""), HasSubstr("no other")));
}

TEST_F(BadInputTest, UncertaintiesAreNotNegative) {
  Append(yaml_, "parameters: {tilt_x: {consider: 0, u: -0.1}}\n");
  ExpectRefused(AllOf(StartsWith(yaml_.string() + ":11:"), HasSubstr("tilt_x: u: found \"-0.1\", expected")));
}

TEST_F(BadInputTest, InfluencesAreNotNegative) {
  Append(yaml_, "influences: {noise_y: -1}\n");
  ExpectRefused(AllOf(StartsWith(yaml_.string() + ":11:"), HasSubstr("noise_y: found \"-1\", expected")));
}

TEST_F(BadInputTest, AnIntervalUpsideDownIsRefused) {
  Replace(yaml_, "[110, 130]", "[130, 110]");
  ExpectRefused(
      AllOf(StartsWith(yaml_.string() + ":6:"), HasSubstr("search: M: found [130, 110], expected the lower")));
}

TEST_F(BadInputTest, AKeepIntervalUpsideDownIsRefused) {
  Replace(yaml_, "scan: left.csv", "scan: left.csv, keep: {angle: [5, -5]}");
  ExpectRefused(AllOf(StartsWith(yaml_.string() + ":8:"), HasSubstr("keep: angle: found [5, -5], expected the lower")));
}

TEST_F(BadInputTest, AKeepThatKeepsNothingIsTold) {
  Replace(yaml_, "scan: left.csv", "scan: left.csv, keep: {angle: [30, 40]}");
  ExpectRefused(AllOf(StartsWith(left_.string()), HasSubstr("no point is left"), HasSubstr("keep")));
}

TEST_F(BadInputTest, DegreesDeclaredAsRadians) {
  Replace(yaml_, "angle: deg", "angle: rad");
  ExpectRefused(AllOf(HasSubstr("left"), HasSubstr("span 30 rad"), HasSubstr("degrees declared as rad")));
}

TEST_F(BadInputTest, RadiansDeclaredAsDegrees) {
  ScaleColumns(std::numbers::pi / 180, 1);
  ExpectRefused(AllOf(HasSubstr("span 0.524 deg"), HasSubstr("declare angle: rad")));
}

TEST_F(BadInputTest, MillimetresDeclaredAsMetres) {
  Replace(yaml_, "length: mm", "length: m");
  ExpectRefused(
      AllOf(StartsWith(yaml_.string() + ":6:"), HasSubstr("search: M"), HasSubstr("is units: length: right?")));
  Replace(yaml_, "search: {M: [110, 130], N: [395, 425], step: 1}",
          "search: {M: [0.11, 0.13], N: [0.395, 0.425], step: 0.001}");
  ExpectRefused(AllOf(HasSubstr("left"), HasSubstr("mm declared as m")));
}

TEST_F(BadInputTest, MetresDeclaredAsMillimetres) {
  ScaleColumns(1, 0.001);
  ExpectRefused(AllOf(HasSubstr("0.2267 mm"), HasSubstr("m declared as mm")));
}

TEST_F(BadInputTest, MillimetresDeclaredAsMicrometres) {
  Replace(yaml_, "length: mm", "length: um");
  ExpectRefused(AllOf(HasSubstr("0.2267 mm"), HasSubstr("um")));
}

TEST_F(BadInputTest, BinaryDataAreNoText) {
  std::string bytes(3000, '\0');
  std::mt19937 random(1);
  for (char& byte : bytes) byte = static_cast<char>(random());
  WriteWhole(left_, bytes);
  ExpectRefused(AllOf(StartsWith(left_.string() + ": found binary data"), HasSubstr("expected text")));
}

TEST_F(BadInputTest, TextIsNoNpy) {
  fs::copy(left_, data_ / "left.npy");
  Replace(yaml_, "scan: left.csv", "scan: left.npy, columns: [angle, y, z]");
  ExpectRefused(StartsWith((data_ / "left.npy").string() + ": "));
}

TEST_F(BadInputTest, AnotherModelIsUnknown) {
  Replace(yaml_, "model: turntable", "model: turntabel");
  ExpectRefused(
      AllOf(StartsWith(yaml_.string() + ":2:8: model: found \"turntabel\", expected"), EndsWith("turntable")));
}

TEST_F(BadInputTest, OneProfileMakesNoPlane) {
  WritePoints(left_, Profiles(ReadPoints(left_)).front());
  ExpectRefused(AllOf(HasSubstr("left"), HasSubstr("two angles")));
}

}  // namespace
}  // namespace scancal
