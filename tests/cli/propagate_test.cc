// scancal propagate: points and distances with their uncertainty.
#include <gmock/gmock.h>
#include <array>
#include <cmath>
#include <cstring>
#include "io/units.h"
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class PropagateTest : public CliTest {
 protected:
  PropagateTest() {
    Append(data_ / "dataset.yaml", "influences: {scale_y: 1e-3}\nparameters: {tilt_x: {consider: 0, u: 0.01}}\n");
    result_ = Refined(data_);
  }
  Outcome Propagate(std::vector<std::string> flags) const {
    flags.insert(flags.begin(), {"propagate", calibration_.string()});
    return RunScancal(flags);
  }
  std::string Refusal(const std::vector<std::string>& flags) const {
    const Outcome outcome = Propagate(flags);
    EXPECT_EQ(outcome.exit_code, 1) << ::testing::PrintToString(outcome);
    EXPECT_EQ(outcome.out, "");
    return OneSentence(outcome);
  }
  // The cells of a CSV file by column, those of the header first.
  static std::vector<std::vector<std::string>> Cells(const fs::path& path) {
    std::vector<std::vector<std::string>> rows;
    for (const std::string& line : Lines(ReadWhole(path))) {
      std::vector<std::string>& row = rows.emplace_back(1);
      for (const char c : line) {
        if (c == ',') row.emplace_back();
        else row.back() += c;
      }
    }
    return rows;
  }
  static double CellOf(const std::vector<std::vector<std::string>>& table, size_t row, const std::string& column) {
    for (size_t c = 0; c < table[0].size(); ++c)
      if (table[0][c] == column) return std::stod(table.at(row).at(c));
    ADD_FAILURE() << "no column " << column;
    return std::nan("");
  }

  const fs::path data_ = MakeData(), calibration_ = Path("out") / "calibration.json";
  Json result_;
};

TEST_F(PropagateTest, APointLiesWhereEquationSevenPutsIt) {
  const Outcome outcome = Propagate({"--point=10,50,-20", "--out=" + Path("points.csv").string()});
  EXPECT_EQ(outcome.exit_code, 0) << ::testing::PrintToString(outcome);
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("10.0000  50.0000  -20.0000"), HasSubstr("u of one reading, 0.0"),
                                 Not(HasSubstr("distance"))));
  const auto table = Cells(Path("points.csv"));
  ASSERT_EQ(table.size(), 2U);
  const double c = std::cos(10 * kDegree), s = std::sin(10 * kDegree), m = ValueOf(result_, "M"),
               n = ValueOf(result_, "N");
  EXPECT_NEAR(CellOf(table, 1, "X_mm"), m * c - (n + 50) * s, 1e-9);
  EXPECT_NEAR(CellOf(table, 1, "Y_mm"), -m * s - (n + 50) * c, 1e-9);
  EXPECT_NEAR(CellOf(table, 1, "Z_mm"), -20, 1e-9);
  // scale_y moves M, N and the depth by 1e-3 of themselves, whatever else there is.
  EXPECT_GT(CellOf(table, 1, "u_Y_mm"), 1e-3 * (n + 50) * 0.9);
  EXPECT_LT(CellOf(table, 1, "u_Y_mm"), 1e-3 * (n + 50) * 1.3);
  EXPECT_NEAR(CellOf(table, 1, "u_Z_mm"), 50 * 0.01 * kDegree, 1e-6);  // of tilt_x
  EXPECT_GT(CellOf(table, 1, "U_max_mm"), CellOf(table, 1, "U_Y_mm"));
}

TEST_F(PropagateTest, PointsMayBeGivenInManyWays) {
  WriteWhole(Path("points.csv"), "name,z,alpha_rad,y_um\nc,1,0.05,60000\n");
  EXPECT_EQ(Propagate({"--point=1,50,0;2,55,1", "--point=-3,60,2", "--points_file=" + Path("points.csv").string(),
                       "--out=" + Path("a.csv").string()})
                .exit_code,
            0);
  const auto table = Cells(Path("a.csv"));
  ASSERT_EQ(table.size(), 5U);
  for (const auto& [row, alpha, y] :
       {std::tuple{1, 1.0, 50.0}, {2, 2.0, 55.0}, {3, -3.0, 60.0}, {4, 0.05 / kDegree, 60.0}}) {
    EXPECT_NEAR(CellOf(table, row, "alpha_deg"), alpha, 1e-12);
    EXPECT_NEAR(CellOf(table, row, "y_mm"), y, 1e-9);
  }
  // What was written is a table of points.
  EXPECT_EQ(Propagate({"--points_file=" + Path("a.csv").string(), "--out=" + Path("b.csv").string()}).exit_code, 0);
  EXPECT_EQ(ReadWhole(Path("b.csv")), ReadWhole(Path("a.csv")));
  EXPECT_EQ(
      Propagate({"--units=m,rad", "--point=" + std::to_string(kDegree) + ",0.05,0", "--out=" + Path("c.csv").string()})
          .exit_code,
      0);
  EXPECT_NEAR(CellOf(Cells(Path("c.csv")), 1, "X_mm"), CellOf(table, 1, "X_mm"), 1e-3);
}

TEST_F(PropagateTest, DistancesAreFromEachPointToTheNext) {
  const Outcome outcome =
      Propagate({"--point=0,50,0; 0,60,0; 10,60,0", "--distance", "--out=" + Path("points.csv").string()});
  EXPECT_EQ(outcome.exit_code, 0) << ::testing::PrintToString(outcome);
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("\n1 to 2    10.000(10)  0.010  0.020"), HasSubstr("\n2 to 3  ")));  // u = 1e-3 of it
  const auto table = Cells(Path("points.csv"));
  EXPECT_NEAR(CellOf(table, 2, "distance_mm"), 10, 1e-9);
  EXPECT_NEAR(CellOf(table, 2, "u_distance_mm"), 0.01, 1e-6);
  EXPECT_GT(CellOf(table, 3, "distance_mm"), 80);
}

// What a scan has: columns of that name, of a lidar, and the angle as the encoder shows it.
TEST_F(PropagateTest, ReadingsAreThoseOfAScan) {
  const auto position = [&](const std::vector<std::string>& flags) {
    std::vector<std::string> all = flags;
    all.push_back("--out=" + Path("p.csv").string());
    const Outcome outcome = Propagate(all);
    EXPECT_EQ(outcome.exit_code, 0) << ::testing::PrintToString(outcome);
    EXPECT_EQ(outcome.err, "");
    const auto table = Cells(Path("p.csv"));
    return std::array{CellOf(table, 1, "X_mm"), CellOf(table, 1, "Y_mm"), CellOf(table, 1, "Z_mm")};
  };
  const auto expect_near = [](const std::array<double, 3>& a, const std::array<double, 3>& b) {
    for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-9);
  };
  const auto expected = position({"--point=-10,50,-20"});
  expect_near(position({"--point=350,50,-20"}), expected);  // the same place
  WriteWhole(Path("points.csv"), "Angle [deg];Y [mm];Z [mm]\n-10;50;-20\n");
  expect_near(position({"--points_file=" + Path("points.csv").string()}), expected);
  char lidar[99];
  std::snprintf(lidar, sizeof lidar, "angle,bearing_rad,range\n-10,%.17g,%.17g\n", std::atan2(-20, 50),
                std::hypot(50, 20));
  WriteWhole(Path("points.csv"), lidar);
  expect_near(position({"--points_file=" + Path("points.csv").string()}), expected);
  Replace(data_ / "dataset.yaml", "rotation: clockwise", "rotation: counterclockwise");
  Replace(data_ / "dataset.yaml", "M: [110, 130]", "M: [-130, -110]");  // its mirror image
  const Json other = Refined(data_);
  const double c = std::cos(10 * kDegree), s = std::sin(10 * kDegree), m = ValueOf(other, "M"), n = ValueOf(other, "N");
  const auto turned = position({"--point=-10,50,-20"});  // clockwise by 10 degrees
  EXPECT_NEAR(turned[0], m * c - (n + 50) * s, 1e-9);
  EXPECT_NEAR(turned[1], -m * s - (n + 50) * c, 1e-9);
}

TEST_F(PropagateTest, PointsThatWereNotScannedAreWarnedOf) {
  const Outcome outcome = Propagate({"--point=80,50,0"});
  EXPECT_EQ(outcome.exit_code, 0) << ::testing::PrintToString(outcome);
  EXPECT_THAT(OneSentence(outcome),
              AllOf(StartsWith("warning: "), HasSubstr("alpha = 80 deg (scanned: -15 to 15 deg)")));
}

TEST_F(PropagateTest, WrongInputIsRefused) {
  EXPECT_THAT(Refusal({}), HasSubstr("no points: "));
  EXPECT_THAT(Refusal({"--point=1,2"}), HasSubstr("point \"1,2\": found 2 values, expected 3: angle, y, z"));
  EXPECT_THAT(Refusal({"--point=1,2,3", "--point=1,2,up"}), HasSubstr("z: found \"up\""));
  EXPECT_THAT(Refusal({"--point=1,2,3", "--units=inch,deg"}), HasSubstr("found \"inch,deg\""));
  WriteWhole(Path("points.csv"), "angle,x,z\n1,2,3\n");
  const std::string file = "--points_file=" + Path("points.csv").string();
  EXPECT_THAT(Refusal({file}), AllOf(HasSubstr("points.csv:1: found the columns angle, x, z"), HasSubstr("'y'")));
  WriteWhole(Path("points.csv"), "");
  EXPECT_THAT(Refusal({file}), HasSubstr("points.csv: no points"));
  EXPECT_THAT(Refusal({"--point=1,2,3", "second.json"}), HasSubstr("found 2 arguments, expected one"));
  EXPECT_THAT(Refusal({"--point=0,50,0", "--out=/proc/points.csv"}), HasSubstr("/proc/points.csv: cannot be written"));
}

TEST_F(PropagateTest, ACalibrationOfAnOlderVersionIsRefused) {
  WriteWhole(calibration_, R"({"scancal": 1, "model": "turntable", "status": "ok", "covariance": [[1, 0], [0, 1]],
             "parameters": [{"name": "M", "value": 100}, {"name": "N", "value": 400}]})");
  EXPECT_THAT(Refusal({"--point=0,50,0"}), AllOf(HasSubstr("older version"), HasSubstr("refine the data again")));
  WriteWhole(calibration_, R"({"scancal": 1, "model": "sextant", "status": "ok", "parameters": []})");
  EXPECT_THAT(Refusal({"--point=0,50,0"}),
              HasSubstr("calibration.json: model: found \"sextant\", expected one of: turntable"));
}

// transform --u and propagate agree to the digits, in each format.
TEST_F(PropagateTest, ACloudHasTheUOfItsPoints) {
  EXPECT_EQ(Propagate({"--points_file=" + (data_ / "left.csv").string(), "--out=" + Path("p.csv").string()}).exit_code,
            0);
  const auto transform = [&](const std::string& name, std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"transform", data_.string(), "--calibration=" + calibration_.string(),
                                 "--out=" + Path(name).string()});
    const Outcome outcome = RunScancal(flags);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return ReadWhole(Path(name));
  };
  transform("c.csv", {"--u", "--covariance"});
  const auto points = Cells(Path("p.csv")), cloud = Cells(Path("c.csv"));
  ASSERT_EQ(points.size(), 801U);
  ASSERT_EQ(cloud.size(), 2401U);
  EXPECT_EQ(cloud[0].size(), 13U);
  for (size_t row = 1; row < points.size(); row += 7) {
    for (const auto& [there, here] : {std::pair{"X_mm", "x_mm"},
                                      {"Z_mm", "z_mm"},
                                      {"u_X_mm", "u_x_mm"},
                                      {"u_Y_mm", "u_y_mm"},
                                      {"u_Z_mm", "u_z_mm"},
                                      {"cov_XY_mm2", "cov_xy_mm2"},
                                      {"cov_XZ_mm2", "cov_xz_mm2"},
                                      {"cov_YZ_mm2", "cov_yz_mm2"}})
      ASSERT_EQ(CellOf(points, row, there), CellOf(cloud, row, here)) << row << " " << here;
    ASSERT_NEAR(std::pow(CellOf(points, row, "u_Y_mm"), 2), CellOf(cloud, row, "cov_yy_mm2"), 1e-15);
  }
  const std::string ply = transform("c.ply", {"--u"});
  EXPECT_THAT(ply.substr(0, 400), AllOf(HasSubstr("property double z\nproperty double u_x\n"), Not(HasSubstr("cov"))));
  const size_t at = ply.find("end_header\n") + 11;
  ASSERT_EQ(ply.size(), at + 2400 * (6 * sizeof(double) + sizeof(int32_t)));
  double u_x = 0;
  std::memcpy(&u_x, ply.data() + at + 3 * sizeof(double), sizeof u_x);
  EXPECT_EQ(u_x, CellOf(cloud, 1, "u_x_mm"));
  EXPECT_THAT(transform("c.npy", {"--covariance"}), HasSubstr("'shape': (2400, 9)"));
}

TEST_F(PropagateTest, TheVolumeIsInTheResult) {
  const Json& volume = result_["volume"];
  ASSERT_EQ(volume["rows"].size(), 125U);
  EXPECT_EQ(volume["columns"], Json({"alpha", "y", "z", "X", "Y", "Z", "U_x", "U_y", "U_z", "U_max"}));
  EXPECT_EQ(volume["units"][0], "rad");
  // A node is a point like any other.
  const Json& node = volume["rows"][37];
  char point[99];
  std::snprintf(point, sizeof point, "--point=%.17g,%.17g,%.17g", node[0].get<double>(), node[1].get<double>(),
                node[2].get<double>());
  EXPECT_EQ(Propagate({point, "--units=mm,rad", "--out=" + Path("node.csv").string()}).exit_code, 0);
  const auto table = Cells(Path("node.csv"));
  EXPECT_NEAR(CellOf(table, 1, "X_mm"), node[3].get<double>(), 1e-9);
  EXPECT_NEAR(CellOf(table, 1, "U_max_mm"), node[9].get<double>(), 1e-12);
  EXPECT_THAT(Refine(data_).out, HasSubstr("expanded uncertainty of a measured point over the scanned volume: 0."));
}

}  // namespace
}  // namespace scancal
