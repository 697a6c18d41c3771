// scancal convert: one format to another, by the readers of scans.
#include <gmock/gmock.h>
#include "tests/cli/data_set.h"
#include "tests/io/ros_bags.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class ConvertTest : public CliTest {
 protected:
  Outcome Convert(const fs::path& in, const fs::path& out, const std::string& as = "") const {
    std::vector<std::string> arguments = {"convert", in.string(), out.string()};
    if (!as.empty()) arguments.push_back("--as=" + as);
    return RunScancal(arguments);
  }
  std::string Refusal(const fs::path& in, const fs::path& out, const std::string& as = "") const {
    const Outcome outcome = Convert(in, out, as);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
    return OneSentence(outcome);
  }
};

// The profiles of a Gocator, whose Z grows towards the sensor.
std::string GocatorCsv(const std::vector<std::vector<ScanPoint>>& profiles) {
  std::string text = "Info\nCSV Version,Sensor Count\n2,1\nEnd\nRawProfile\nFrame Count,Column Count,X Offset\n" +
                     std::to_string(profiles.size()) + "," + std::to_string(profiles[0].size()) +
                     ",0\n\nFrame,Source,Time,Encoder,Axis";
  for (size_t k = 0; k < profiles[0].size(); ++k) text += "," + std::to_string(k);
  char cell[80];
  for (size_t p = 0; p < profiles.size(); ++p)
    for (const char* axis : {"X", "Z"}) {
      std::snprintf(cell, sizeof cell, "\n%zu,0,%zu,%.6f,%s", p, 10 * p, 1e6 * profiles[p][0].angle, axis);
      text += cell;
      for (const ScanPoint& point : profiles[p]) {
        std::snprintf(cell, sizeof cell, ",%.17g", *axis == 'X' ? point.z : -point.y);
        text += cell;
      }
    }
  return text + "\nEnd\n";
}

TEST_F(ConvertTest, AGocatorIsCalibratedAsItIsAndConverted) {
  const fs::path data = MakeData();
  const Json expected = Refined(data);
  for (const std::string& name : kNames)
    WriteWhole(data / (name + ".csv"), GocatorCsv(Profiles(ReadPoints(data / (name + ".csv")))));
  Append(data / "dataset.yaml", "angle: {column: Encoder, counts_per_turn: 3.6e8}\n");
  EXPECT_THAT(OneSentence(Refine(data)), HasSubstr("its maker counts y towards the sensor, expected depth: towards"));
  Append(data / "dataset.yaml", "depth: towards\n");
  EXPECT_THAT(Refine(data).out, HasSubstr("Text: Gocator CSV, RawProfile in line 5: y is its Z and z its X, in mm, "
                                          "angle from Encoder, 360000000 counts a turn."));
  const auto expect_same = [&](const Json& found) {
    for (const char* name : {"M", "N"})
      EXPECT_NEAR(ValueOf(found, name), ValueOf(expected, name), 1e-3 * UOf(expected, name)) << name;
  };
  expect_same(Refined(data));
  for (const std::string& name : kNames) {
    const Outcome outcome =
        Convert(data / (name + ".csv"), data / (name + ".ply"), "angle: {column: Encoder, counts_per_turn: 3.6e8}");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("Gocator CSV, RawProfile"), HasSubstr("wrote 800 points to "),
                                   HasSubstr("0 missing left out; columns: [angle_rad, time, z_mm, y_mm, profile]")));
    EXPECT_EQ(Convert(data / (name + ".ply"), data / (name + ".npy")).exit_code, 0);
    Replace(data / "dataset.yaml", "scan: " + name + ".csv", "scan: " + name + ".npy");
  }
  Replace(data / "dataset.yaml", "angle: {column: Encoder, counts_per_turn: 3.6e8}",
          "columns: [angle_rad, profile, time, y_mm, z_mm]");
  expect_same(Refined(data));
}

TEST_F(ConvertTest, WhatIsWrongIsToldInOneSentenceAndNothingIsWritten) {
  const fs::path in = Path("in.csv"), out = Path("out.csv");
  WriteWhole(in, "Frame,y,z\n1,2,3\n");
  EXPECT_THAT(Refusal(in, out), HasSubstr("expected also 'angle'"));
  EXPECT_THAT(Refusal(in, out, "{columns: {angle: Frame}, colums: 1}"), HasSubstr("--as:1:27: unknown key 'colums'"));
  EXPECT_THAT(Refusal(in, out, "format: gokator"),
              HasSubstr("expected one of gocator, lj-v, lj-x, image, ply, pcd, ros1, ros2"));
  EXPECT_THAT(Refusal(in, Path("out.xyz"), "columns: {angle: Frame}"), HasSubstr("expected .csv, .npy, .ply or .pcd"));
  EXPECT_THAT(Refusal(in, in, "columns: {angle: Frame}"), HasSubstr("that is the file to read"));
  EXPECT_THAT(Refusal(Path("absent.csv"), out), HasSubstr("no such file"));
  EXPECT_THAT(OneSentence(RunScancal({"convert", in.string()})), HasSubstr("found 1 arguments, expected two"));
  EXPECT_FALSE(fs::exists(out));
}

TEST_F(ConvertTest, TheStandardInput) {
  const fs::path in = Path("in.csv"), array = Path("array.npy"), out = Path("out.csv");
  WriteWhole(in, "angle_rad,y_mm,z_mm\n1,2,3\n4,5,6\n");
  EXPECT_EQ(Convert(in, array).exit_code, 0);
  const Outcome outcome = RunScancal({"convert", "-", out.string(), "--as=columns: [angle_rad, y_mm, z_mm]"},
                                     {.folder = {}, .largest_file = {}, .input = array});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(ReadWhole(out), ReadWhole(in));
  EXPECT_THAT(Refusal("-", out), HasSubstr("the standard input is closed or a terminal, expected a file or a pipe"));
}

TEST_F(ConvertTest, DepthIsAsItWas) {
  const fs::path in = Path("in.csv"), out = Path("out.csv");
  WriteWhole(in, "angle_rad,y_mm,z_mm\n1,2,3\n4,5,6\n");
  EXPECT_THAT(Convert(in, out, "depth: towards").out,
              HasSubstr("depth is as it was: a data set of " + out.string() + " declares depth: towards"));
  EXPECT_EQ(ReadWhole(out), ReadWhole(in));
  EXPECT_THAT(Convert(in, out, "depth: away").out, Not(HasSubstr("declares depth")));
  EXPECT_THAT(Refusal(in, out, "depth: down"), HasSubstr("expected away or towards"));
}

TEST_F(ConvertTest, ABagWithTheTopicAndTheJointThatAreNamed) {
  const fs::path in = Path("run.bag"), out = Path("out.csv");
  WriteWhole(in, Ros1BagOf({JointMessage(false, 1, {"pan", "tilt"}, {9, 0}), ScanMessage(false, 2, {1, 2}),
                            ScanMessage(false, 2, {5}, 0, "/back"), JointMessage(false, 3, {"pan", "tilt"}, {9, 1})}));
  EXPECT_THAT(Convert(in, out, "{topic: /scan, joint: tilt, joint_topic: /joint_states}").out,
              HasSubstr("ROS 1 bag: 1 scan of /scan, angle from tilt in /joint_states in the middle of each"));
  EXPECT_EQ(ReadWhole(out), "bearing_rad,range_mm,profile,time,angle_rad\n-0.5,1000,1,0,0.5\n-0.25,2000,1,0,0.5\n");
  EXPECT_THAT(Refusal(in, out, "topic: /scan"), HasSubstr("found the joints pan, tilt, expected the one that turns"));
}

}  // namespace
}  // namespace scancal
