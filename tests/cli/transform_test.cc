// scancal transform: the points of the scans in the table frame.
#include <gmock/gmock.h>
#include <array>
#include <cstring>
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

struct CloudPoint {
  std::array<double, 3> p;
  int scan = 0;
};

class TransformTest : public CliTest {
 protected:
  TransformTest() { EXPECT_EQ(Refine(data_).exit_code, 0); }

  Outcome Transform(const fs::path& out) const {
    return RunScancal({"transform", data_.string(), "--calibration=" + calibration_.string(), "--out=" + out.string()});
  }
  std::string TransformedTo(const std::string& name) const {
    const Outcome outcome = Transform(Path(name));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_THAT(outcome.out, HasSubstr("wrote 2400 points in mm to "));
    return ReadWhole(Path(name));
  }
  std::string Refusal(const fs::path& out) const {
    const Outcome outcome = Transform(out);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
    return OneSentence(outcome);
  }

  // On the planes of truth.json, within noise and the uncertainty of M and N.
  void ExpectOnTruePlanes(const std::vector<CloudPoint>& points) const {
    ASSERT_EQ(points.size(), 2400U);
    const auto truth = ReadJson(data_ / "truth.json");
    ASSERT_TRUE(truth.ok());
    std::array<double, 3> squares = {};
    for (const CloudPoint& point : points) {
      const Json& plane = (*truth)["targets"][static_cast<size_t>(point.scan)];
      double distance = -plane["distance"].get<double>();
      for (size_t i = 0; i < 3; ++i) distance += plane["normal"][i].get<double>() * point.p[i];
      EXPECT_LT(std::abs(distance), 0.5);
      squares[static_cast<size_t>(point.scan)] += distance * distance / 800;
    }
    for (const double square : squares) {
      EXPECT_GT(std::sqrt(square), 0.03);  // noise 0.05 mm along depth, and N is 0.13 mm off
      EXPECT_LT(std::sqrt(square), 0.2);
    }
  }

  const fs::path data_ = MakeData();
  const fs::path calibration_ = Path("out") / "calibration.json";
};

std::vector<CloudPoint> FromCsv(const std::string& text) {
  std::vector<CloudPoint> points;
  const std::vector<std::string> lines = Lines(text);
  EXPECT_EQ(lines.at(0), "x_mm,y_mm,z_mm,scan");
  for (size_t i = 1; i < lines.size(); ++i) {
    CloudPoint& c = points.emplace_back();
    EXPECT_EQ(std::sscanf(lines[i].c_str(), "%lf,%lf,%lf,%d", &c.p[0], &c.p[1], &c.p[2], &c.scan), 4) << lines[i];
  }
  return points;
}

TEST_F(TransformTest, CsvPointsLieOnTheTruePlanes) { ExpectOnTruePlanes(FromCsv(TransformedTo("cloud.csv"))); }

TEST_F(TransformTest, PlyHoldsTheSamePoints) {
  const std::vector<CloudPoint> expected = FromCsv(TransformedTo("cloud.csv"));
  const std::string bytes = TransformedTo("cloud.ply");
  const std::string end = "end_header\n";
  const size_t at = bytes.find(end) + end.size();
  EXPECT_THAT(bytes.substr(0, at),
              AllOf(StartsWith("ply\nformat binary_little_endian 1.0\n"), HasSubstr("\nelement vertex 2400\n")));
  constexpr size_t kRecord = 3 * sizeof(double) + sizeof(int32_t);
  ASSERT_EQ(bytes.size(), at + 2400 * kRecord);
  for (size_t i = 0; i < expected.size(); ++i) {
    std::array<double, 3> p;
    int32_t scan = 0;
    std::memcpy(p.data(), bytes.data() + at + i * kRecord, sizeof p);
    std::memcpy(&scan, bytes.data() + at + i * kRecord + sizeof p, sizeof scan);
    ASSERT_EQ(p, expected[i].p);
    ASSERT_EQ(scan, expected[i].scan);
  }
}

TEST_F(TransformTest, NpyHoldsTheSamePoints) {
  const std::vector<CloudPoint> expected = FromCsv(TransformedTo("cloud.csv"));
  const std::string bytes = TransformedTo("cloud.npy");
  EXPECT_THAT(bytes, AllOf(StartsWith("\x93NUMPY"), HasSubstr("'shape': (2400, 3)"), HasSubstr("'<f8'")));
  const size_t at = bytes.size() - 2400 * 3 * sizeof(double);
  EXPECT_EQ(at % 64, 0U);
  EXPECT_EQ(bytes[at - 1], '\n');
  for (size_t i = 0; i < expected.size(); ++i) {
    std::array<double, 3> p;
    std::memcpy(p.data(), bytes.data() + at + i * sizeof p, sizeof p);
    ASSERT_EQ(p, expected[i].p);
  }
}

TEST_F(TransformTest, MissingPointsAreLeftOut) {
  SetLine(data_ / "left.csv", 5, "-15,nan,0");
  const Outcome outcome = Transform(Path("cloud.csv"));
  EXPECT_THAT(outcome.out, HasSubstr("wrote 2399 points"));
  EXPECT_EQ(Lines(ReadWhole(Path("cloud.csv"))).size(), 2400U);
}

TEST_F(TransformTest, TheTableFrameIsEquationSeven) {
  // M = 100, N = 400, alpha = 30 deg, y = 50, z = 7: worked out by hand from x = M cos a - (N + y) sin a and y = -M sin
  // a - (N + y) cos a.
  WriteWhole(calibration_,
             R"({"scancal": 1, "model": "turntable", "status": "ok",
                 "parameters": [{"name": "M", "value": 100}, {"name": "N", "value": 400}]})");
  WriteWhole(data_ / "left.csv", "angle,y,z\n30,50,7\n");
  const std::vector<CloudPoint> points = FromCsv((Transform(Path("cloud.csv")), ReadWhole(Path("cloud.csv"))));
  ASSERT_FALSE(points.empty());
  EXPECT_NEAR(points[0].p[0], 86.60254037844386 - 225, 1e-9);
  EXPECT_NEAR(points[0].p[1], -50 - 389.7114317029974, 1e-9);
  EXPECT_NEAR(points[0].p[2], 7, 1e-12);
}

TEST_F(TransformTest, PathsMayHaveBlanksAndQuotes) {
  const std::string name = "new folder/the plate's \"cloud\" $1;.csv";
  EXPECT_EQ(TransformedTo(name), TransformedTo("cloud.csv"));
}

TEST_F(TransformTest, AnUnknownExtensionIsRefused) {
  EXPECT_THAT(Refusal(Path("cloud.xyz")),
              AllOf(HasSubstr("cloud.xyz"), HasSubstr("'.xyz'"), HasSubstr("expected .ply, .csv or .npy")));
  EXPECT_THAT(Refusal(Path("cloud")), HasSubstr("expected .ply, .csv or .npy"));
  EXPECT_FALSE(fs::exists(Path("cloud.xyz")));
}

TEST_F(TransformTest, AFolderThatCannotBeWrittenIsTold) {
  EXPECT_THAT(Refusal("/proc/cloud.csv"), HasSubstr("/proc/cloud.csv: cannot be written: "));
  EXPECT_THAT(Refusal(data_ / "left.csv" / "cloud.csv"), HasSubstr("left.csv is a file, expected a folder"));
  fs::create_directory(Path("folder.ply"));
  EXPECT_THAT(Refusal(Path("folder.ply")), HasSubstr("found a folder, expected a file"));
}

TEST_F(TransformTest, AReadOnlyFolderIsTold) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  fs::create_directory(Path("locked"));
  fs::permissions(Path("locked"), fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_THAT(Refusal(Path("locked") / "cloud.csv"), HasSubstr("cannot be written: Permission denied"));
}

TEST_F(TransformTest, OtherFilesAreNoCalibration) {
  const auto refused = [&](const std::string& contents) {
    WriteWhole(calibration_, contents);
    return Refusal(Path("cloud.csv"));
  };
  const std::string file = calibration_.string();
  EXPECT_THAT(refused(""), StartsWith(file + ": the file is empty"));
  EXPECT_THAT(refused("{\n  \"scancal\": 1,\n  oops"), StartsWith(file + ":3:3: not JSON: "));
  EXPECT_THAT(refused("{}"), AllOf(StartsWith(file + ": "), HasSubstr("\"scancal\": 1")));
  EXPECT_THAT(refused("[1, 2]"), AllOf(StartsWith(file + ": "), HasSubstr("is it a calibration.json?")));
  EXPECT_THAT(refused(R"({"scancal": 2})"), HasSubstr("expected format version 1, found 2"));
  EXPECT_THAT(refused(R"({"scancal": 1, "model": "turntable"})"), HasSubstr("a list of \"parameters\""));
  EXPECT_THAT(refused(R"({"scancal": 1, "model": "turntable", "status": "ok", "parameters": []})"),
              HasSubstr("no parameter M"));
  EXPECT_THAT(
      refused(R"({"scancal": 1, "model": "turntable", "status": "ok", "parameters": [{"name": "M", "value": null}]})"),
      HasSubstr("a number as \"value\" of M"));
  EXPECT_THAT(refused(R"({"scancal": 1, "model": "turntable", "status": "ok", "parameters": [{"name": 5}]})"),
              HasSubstr("a name"));
  EXPECT_THAT(refused(R"({"scancal": 1, "model": "turntable", "status": 5, "parameters": []})"), StartsWith(file));
  EXPECT_THAT(refused(R"({"scancal": 1, "model": "robot-ball", "status": "ok", "parameters": []})"),
              AllOf(HasSubstr("\"robot-ball\""), HasSubstr("\"turntable\"")));
  EXPECT_FALSE(fs::exists(Path("cloud.csv")));
}

TEST_F(TransformTest, AMissingCalibrationIsNamed) {
  fs::remove(calibration_);
  EXPECT_EQ(Refusal(Path("cloud.csv")), calibration_.string() + ": no such file");
}

TEST_F(TransformTest, ABadScanLeavesTheOldCloud) {
  WriteWhole(Path("cloud.csv"), "old");
  SetLine(data_ / "right.csv", 700, "x,y,z");
  EXPECT_THAT(Refusal(Path("cloud.csv")), HasSubstr("right.csv:700:1: angle: found \"x\""));
  EXPECT_EQ(ReadWhole(Path("cloud.csv")), "old");
  std::vector<std::string> names = folder_.Names();
  std::sort(names.begin(), names.end());
  EXPECT_THAT(names, ::testing::ElementsAre("cloud.csv", "data", "out"));
}

}  // namespace
}  // namespace scancal
