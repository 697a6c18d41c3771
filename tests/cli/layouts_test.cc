// The same measurement written in other ways gives the same result.
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <algorithm>
#include <random>
#include <thread>
#include "io/units.h"
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::HasSubstr;

class LayoutsTest : public CliTest {
 protected:
  void ExpectSameResult(const Json& found, double relative_to_u = 1e-10) const {
    for (const char* name : {"M", "N"}) {
      const double u = UOf(expected_, name);
      EXPECT_NEAR(ValueOf(found, name), ValueOf(expected_, name), relative_to_u * u) << name;
      EXPECT_NEAR(UOf(found, name), u, relative_to_u * u) << name;
    }
  }

  fs::path data_ = MakeData();
  const Json expected_ = Refined(data_);
};

TEST_F(LayoutsTest, ShuffledLinesWithTheColumnProfile) {
  std::mt19937 random(1);
  for (const std::string& name : kNames) {
    std::vector<std::vector<double>> rows;
    const auto profiles = Profiles(ReadPoints(data_ / (name + ".csv")));
    for (size_t k = 0; k < profiles.size(); ++k)
      for (const ScanPoint& p : profiles[k]) rows.push_back({p.y, p.z, static_cast<double>(k), p.angle});
    std::shuffle(rows.begin(), rows.end(), random);
    WriteTable(data_ / (name + ".csv"), "y,z,profile,angle", rows);
  }
  ExpectSameResult(Refined(data_));
}

TEST_F(LayoutsTest, ShuffledLinesWithoutTheColumnAreNoticed) {
  std::mt19937 random(1);
  std::vector<std::vector<double>> rows;
  for (const ScanPoint& p : ReadPoints(data_ / "left.csv")) rows.push_back({p.angle, p.y, p.z});
  std::shuffle(rows.begin(), rows.end(), random);
  WriteTable(data_ / "left.csv", "angle,y,z", rows);
  EXPECT_THAT(Refined(data_)["warnings"].dump(), HasSubstr("add a column profile"));
  EXPECT_EQ(expected_["warnings"].dump().find("add a column profile"), std::string::npos);
}

TEST_F(LayoutsTest, TwoAnglesInOneProfileAreAnError) {
  std::vector<std::vector<double>> rows;
  for (const ScanPoint& p : ReadPoints(data_ / "left.csv")) rows.push_back({p.angle, p.y, p.z, std::floor(p.angle)});
  WriteTable(data_ / "left.csv", "angle,y,z,profile", rows);
  const Outcome outcome = Refine(data_);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(OneSentence(outcome), HasSubstr("expected one angle a profile"));
}

TEST_F(LayoutsTest, CounterclockwiseAnglesCountTheOtherWay) {
  for (const std::string& name : kNames) {
    std::vector<ScanPoint> points = ReadPoints(data_ / (name + ".csv"));
    for (ScanPoint& p : points) p.angle = -p.angle;
    WritePoints(data_ / (name + ".csv"), points);
  }
  Replace(data_ / "dataset.yaml", "rotation: clockwise", "rotation: counterclockwise");
  ExpectSameResult(Refined(data_));
}

TEST_F(LayoutsTest, TheWrongSenseMirrorsM) {  // which planes cannot see: hence only the documentation can warn
  Replace(data_ / "dataset.yaml", "rotation: clockwise", "rotation: counterclockwise");
  Replace(data_ / "dataset.yaml", "M: [110, 130]", "M: [-130, -110]");
  const Json mirrored = Refined(data_);
  EXPECT_NEAR(ValueOf(mirrored, "M"), -ValueOf(expected_, "M"), 1e-6 * UOf(expected_, "M"));
  EXPECT_NEAR(ValueOf(mirrored, "N"), ValueOf(expected_, "N"), 1e-6 * UOf(expected_, "N"));
}

TEST_F(LayoutsTest, OtherUnitsGiveTheSameMillimetres) {
  for (const std::string& name : kNames) {
    std::vector<std::vector<double>> rows;
    for (const ScanPoint& p : ReadPoints(data_ / (name + ".csv")))
      rows.push_back({p.angle * kDegree, p.y / 1000, p.z * 1000});
    WriteTable(data_ / (name + ".csv"), "angle,y,z_um", rows);  // the suffix wins over units
  }
  Replace(data_ / "dataset.yaml", "{length: mm, angle: deg}", "{length: m, angle: rad}");
  Replace(data_ / "dataset.yaml", "search: {M: [110, 130], N: [395, 425], step: 1}",
          "search: {M: [0.11, 0.13], N: [0.395, 0.425], step: 0.001}");
  ExpectSameResult(Refined(data_), 1e-8);
}

TEST_F(LayoutsTest, TheWideLayoutIsTheLongOne) {
  for (const std::string& name : kNames) {
    std::string text = "angle," + std::string(19, ',') + "\n";
    for (const auto& profile : Profiles(ReadPoints(data_ / (name + ".csv")))) {
      char cell[40];
      std::snprintf(cell, sizeof cell, "%.17g", profile.front().angle);
      text += cell;
      for (const ScanPoint& p : profile) {
        std::snprintf(cell, sizeof cell, ",%.17g", p.y);
        text += cell;
      }
      text += "\n";
    }
    WriteWhole(data_ / (name + ".csv"), text);
  }
  Append(data_ / "dataset.yaml",
         "layout: {wide: y, angle_column: 1, first_column: 2, start: -100, step: 10.526315789473685}\n");  // 200 / 19
  ExpectSameResult(Refined(data_), 1e-2);  // z was rounded to 0.1 um in the long one
}

TEST_F(LayoutsTest, ALidarSeesTheSameAxis) {
  const fs::path data = Path("lidar");
  Simulate(data, {"--profiles=40", "--points=20", "--noise=0"});
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.002);  // mm, along the range
  for (const std::string& name : kNames) {
    std::vector<std::vector<double>> rows;
    for (const ScanPoint& p : ReadPoints(data / (name + ".csv")))
      rows.push_back({std::atan2(p.z, p.y) / kDegree, std::hypot(p.y, p.z) + noise(random), p.angle});
    WriteTable(data / (name + ".csv"), "bearing,range,angle", rows);
  }
  const Json result = Refined(data);
  EXPECT_NEAR(ValueOf(result, "M"), 123, 4 * UOf(result, "M"));
  EXPECT_NEAR(ValueOf(result, "N"), 409, 4 * UOf(result, "N"));
  EXPECT_LT(UOf(result, "M"), 0.01);
  EXPECT_LT(UOf(result, "N"), 0.01);
  EXPECT_NEAR(result["sigma"], 0.002, 0.0002);
  EXPECT_EQ(Sentences(result, "warnings"), "");
}

TEST_F(LayoutsTest, KeepKeepsWhatItSays) {
  for (const std::string& name : kNames)
    Replace(data_ / "dataset.yaml", "scan: " + name + ".csv",
            "scan: " + name + ".csv, keep: {angle: [-10, 10], z: [-50, 60]}");
  const Json kept = Refined(data_);
  for (const std::string& name : kNames) {
    std::vector<ScanPoint> points = ReadPoints(data_ / (name + ".csv"));
    std::erase_if(points, [](const ScanPoint& p) { return std::abs(p.angle) > 10 || p.z < -50 || p.z > 60; });
    WritePoints(data_ / (name + ".csv"), points);
    Replace(data_ / "dataset.yaml", ", keep: {angle: [-10, 10], z: [-50, 60]}", "");
  }
  const Json cut = Refined(data_);
  EXPECT_EQ(kept["targets"][0]["points"], 26 * 11);
  EXPECT_EQ(cut["targets"][0]["points"], 26 * 11);
  for (const char* name : {"M", "N"}) EXPECT_NEAR(ValueOf(kept, name), ValueOf(cut, name), 1e-10 * UOf(cut, name));
}

TEST_F(LayoutsTest, ADeclaredInvalidValueIsMissing) {
  for (const std::string& name : kNames) {
    std::vector<ScanPoint> points = ReadPoints(data_ / (name + ".csv"));
    for (size_t i = 0; i < points.size(); i += 10) points[i].y = -9999;
    WritePoints(data_ / (name + ".csv"), points);
  }
  Append(data_ / "dataset.yaml", "invalid: -9999\n");
  const Json result = Refined(data_);
  EXPECT_EQ(result["targets"][0]["missing"], 80);
  EXPECT_EQ(result["targets"][0]["points"], 720);
  EXPECT_EQ(result["targets"][0]["set_aside"], 0);
}

TEST_F(LayoutsTest, CommentsAreSkipped) {
  WriteWhole(data_ / "left.csv", "# made by hand\n" + ReadWhole(data_ / "left.csv") + "# the end\n");
  ExpectSameResult(Refined(data_));
}

// An instrument's own file: metadata, semicolons, decimal commas, units in brackets, counts of an encoder.
TEST_F(LayoutsTest, AnInstrumentsOwnFile) {
  for (const std::string& name : kNames) {
    std::string text = "LINE SCANNER 3000\r\nSerial;4711\r\nDate;2026-11-02\r\n\r\nEncoder;Depth [mm];Line [mm]\r\n";
    for (const ScanPoint& p : ReadPoints(data_ / (name + ".csv"))) {
      char row[99];
      const double count = std::fmod(1200 + p.angle / 360 * 3.6e9 + 2 * 4e7, 4e7);
      std::snprintf(row, sizeof row, "%.6f;%.17g;%.17g\r\n", count, p.y, p.z);
      for (char* c = row; *c; ++c) *c = *c == '.' ? ',' : *c;
      text += row;
    }
    WriteWhole(data_ / (name + ".csv"), text);
  }
  Append(data_ / "dataset.yaml",
         "columns: {y: Depth, z: Line}\nangle: {column: Encoder, counts_per_turn: 3.6e9, zero: 1200, wrap: 4e7}\n");
  ExpectSameResult(Refined(data_), 1e-4);
  const Outcome outcome = Refine(data_);
  EXPECT_THAT(outcome.out, HasSubstr("Text: cells between semicolons, decimal commas, names in line 5, angle from "
                                     "Encoder, 3.6e+09 counts a turn, zero at 1200, starting again after 40000000."));
}

TEST_F(LayoutsTest, AConstantStep) {
  for (const std::string& name : kNames) {
    std::vector<std::vector<double>> rows;
    const auto profiles = Profiles(ReadPoints(data_ / (name + ".csv")));
    for (size_t k = 0; k < profiles.size(); ++k)
      for (const ScanPoint& p : profiles[k]) rows.push_back({static_cast<double>(k + 7), p.y, p.z});
    WriteTable(data_ / (name + ".csv"), "profile,y,z", rows);
  }
  const std::string yaml = ReadWhole(data_ / "dataset.yaml");
  Append(data_ / "dataset.yaml", "angle: {start: -15, step: 0.76923076923076927}\n");
  ExpectSameResult(Refined(data_), 1e-3);
  WriteWhole(data_ / "dataset.yaml", yaml + "angle: {column: profile, speed: 0.76923076923076927, zero: 26.5}\n");
  ExpectSameResult(Refined(data_), 1e-3);
}

TEST_F(LayoutsTest, AnglesInAFileOfTheirOwn) {
  std::string angles = "time;Angle [deg]\n";
  for (const std::string& name : kNames) {
    std::vector<std::vector<double>> rows;
    const auto profiles = Profiles(ReadPoints(data_ / (name + ".csv")));
    for (size_t k = 0; k < profiles.size(); ++k)
      for (const ScanPoint& p : profiles[k]) rows.push_back({10.0 + static_cast<double>(k) / 4, p.y, p.z});
    WriteTable(data_ / (name + ".csv"), "time,y,z", rows);
    if (name != kNames[0]) continue;
    for (const size_t k : {39, 0, 20, 10}) {  // the table turns evenly: fewer will do, in any order
      char row[99];
      std::snprintf(row, sizeof row, "%.17g;%.17g\n", 10.0 + static_cast<double>(k) / 4, profiles[k].front().angle);
      angles += row;
    }
  }
  WriteWhole(data_ / "angles of \"all\".csv", angles);
  Append(data_ / "dataset.yaml", "angle: {file: 'angles of \"all\".csv', by: time}\n");
  const Json result = Refined(data_);
  ExpectSameResult(result, 1e-2);
  EXPECT_EQ(result["inputs"].size(), 5U);
  SetLine(data_ / "left.csv", 2, "9,70,0");
  EXPECT_THAT(OneSentence(Refine(data_)), HasSubstr("time: found no angle at 9, but from 10 to 19.75"));
}

TEST_F(LayoutsTest, WhereOneFileHoldsAll) {
  std::string all = "Plate,angle,y,z\n";
  for (const std::string& name : kNames)
    for (const std::string& line : Lines(ReadWhole(data_ / (name + ".csv"))))
      if (line != "angle,y,z") all += "the " + name + " one," + line + "\n";
  for (const std::string& name : kNames) {
    fs::remove(data_ / (name + ".csv"));
    Replace(data_ / "dataset.yaml", "scan: " + name + ".csv", "scan: all.csv, where: {Plate: the " + name + " one}");
  }
  WriteWhole(data_ / "all.csv", all);
  ExpectSameResult(Refined(data_));
}

TEST_F(LayoutsTest, APipeAndTheStandardInput) {
  const std::string left = ReadWhole(data_ / "left.csv");
  fs::remove(data_ / "left.csv");
  ASSERT_EQ(::mkfifo((data_ / "left.csv").c_str(), 0600), 0);
  for (const bool standard_input : {false, true}) {
    if (standard_input) Replace(data_ / "dataset.yaml", "left.csv", "\"-\"");
    std::thread writer([&] { WriteWhole(data_ / "left.csv", left); });
    Surroundings surroundings;
    if (standard_input) surroundings.input = data_ / "left.csv";
    const fs::path out = data_ / "of a pipe";
    const Outcome outcome = RunScancal({"refine", data_.string(), "--out=" + out.string()}, surroundings);
    writer.join();
    ASSERT_EQ(outcome.exit_code, 0) << ::testing::PrintToString(outcome);
    ExpectSameResult(Json::parse(ReadWhole(out / "calibration.json")));
  }
}

TEST_F(LayoutsTest, SearchIsAskedOnlyWhereSomethingIsSearched) {
  const std::string yaml = ReadWhole(data_ / "dataset.yaml");
  const size_t at = yaml.find("search:"), end = yaml.find('\n', at) + 1;
  WriteWhole(data_ / "dataset.yaml", yaml.substr(0, at) + yaml.substr(end));
  const fs::path calibration = Path("out") / "calibration.json";
  EXPECT_EQ(RunScancal({"transform", data_.string(), "--calibration=" + calibration.string(),
                        "--out=" + Path("cloud.csv").string()})
                .exit_code,
            0);
  EXPECT_THAT(OneSentence(Refine(data_)), HasSubstr("the key 'search' is missing"));
  Append(data_ / "dataset.yaml", "parameters: {M: {hold: 123}, N: {hold: 409}, tilt_x: estimate}\n");
  EXPECT_NE(Refine(data_).exit_code, 1);
}

}  // namespace
}  // namespace scancal
