// A real lidar on a tilt stand: M 80, N 0 mm nominal, known no better than to some centimetres.
#include <gmock/gmock.h>
#include "tests/cli/data_set.h"
#include "tests/real/data_sets.h"

namespace scancal {
namespace {

using ::testing::HasSubstr;

constexpr char kScan[] = "0_to_pos90_degree.csv";

class TiltingLidarTest : public CliTest {
 protected:
  void SetUp() override {
    const fs::path scan = DataSets() / "tilting-lidar" / kScan;
    if (!fs::exists(scan))
      GTEST_SKIP() << "NOT TESTED ON REAL DATA: there is no " << scan
                   << "; set SCANCAL_DATASETS to the folder that holds tilting-lidar/";
    fs::create_directory(data_);
    fs::copy(fs::path(SCANCAL_SOURCE_DIR) / "tests" / "real" / "tilting-lidar" / "dataset.yaml", data_);
    fs::create_symlink(fs::canonical(scan), data_ / kScan);
  }

  const fs::path data_ = Path("lidar");
};

// JSON cannot hold it; what is not known is null, and that may only be where there is nothing to know.
void ExpectNumbers(const Json& json, const std::string& where) {
  EXPECT_FALSE(json.is_null()) << where;
  if (json.is_number_float()) {
    EXPECT_TRUE(std::isfinite(json.get<double>())) << where;
  }
  if (!json.is_structured()) return;
  for (const auto& item : json.items()) {
    const bool of_a_method = where.starts_with("/compare/") && item.value().is_null();  // a step has no u
    if (!of_a_method) ExpectNumbers(item.value(), where + "/" + item.key());
  }
}

TEST_F(TiltingLidarTest, ItsOffsetsComeOutWhereTheDrawingHasThem) {
  const Outcome outcome = Refine(data_);
  ASSERT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 2) << ::testing::PrintToString(outcome);
  EXPECT_EQ(outcome.err, "");
  const Json result = Result();
  EXPECT_EQ(result["status"], outcome.exit_code == 0 ? "ok" : "unreliable");
  EXPECT_NEAR(ValueOf(result, "M"), 80, 60);
  EXPECT_GT(ValueOf(result, "N"), -150);
  EXPECT_LT(ValueOf(result, "N"), 60);
  EXPECT_GT(UOf(result, "M"), 1);
  EXPECT_LT(UOf(result, "M"), 60);
  EXPECT_LT(std::abs(ValueOf(result, "M") - 80), 3 * UOf(result, "M"));
  ASSERT_EQ(result["targets"].size(), 6U);
  double set_aside = 0, missing = 0;
  for (const Json& target : result["targets"]) {
    set_aside += target["set_aside"].get<double>();
    missing += target["missing"].get<double>();
    EXPECT_GT(target["points"].get<double>(), 100) << target["name"];
  }
  EXPECT_GT(set_aside, 0);
  EXPECT_GT(missing, 0);
  ExpectNumbers(result, "");
  EXPECT_THAT(outcome.out, HasSubstr("URG-04LX lidar on a tilt stand: turntable, lengths in m, angles in deg"));
}

// The search has no minimum near the result; moving the edge away from it must not hide that.
TEST_F(TiltingLidarTest, AWiderSearchDoesNotMakeItReliable) {
  std::string yaml = ReadWhole(data_ / "dataset.yaml");
  const std::string narrow = "N: [-0.3, 0.3]";
  ASSERT_NE(yaml.find(narrow), std::string::npos);
  WriteWhole(data_ / "dataset.yaml", yaml.replace(yaml.find(narrow), narrow.size(), "N: [-0.6, 0.3]"));
  const Outcome outcome = Refine(data_);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.out, HasSubstr("the grid minimum lies"));
}

// What is plane in the whole scan, found: desk, wall and floor in both sweeps. M and N of the two sweeps agree within
// their U, or nobody says that they are reliable.
TEST_F(TiltingLidarTest, PlanesAreFoundInItsScan) {
  const fs::path file = data_ / "dataset.yaml";
  const std::string declared = ReadWhole(file);
  const auto declare = [&](const std::string& planes) {
    WriteWhole(file, declared.substr(0, declared.find("targets:")) + "planes: " + planes +
                         "\ntargets:\n  - {name: room, scan: " + kScan + "}\n");
  };
  declare("find");
  const Outcome found = RunScancal({"planes", data_.string(), "--out=" + data_.string()});
  ASSERT_EQ(found.exit_code, 0) << found.err;
  const std::string planes = ReadWhole(data_ / "planes.yaml");
  Json results[2];
  for (const int k : {0, 1}) {
    const std::string other = k == 0 ? " down\"" : " up\"";
    std::string kept = planes;
    for (size_t at = kept.rfind("      - name: "); at != std::string::npos;
         at = at == 0 ? std::string::npos : kept.rfind("      - name: ", at - 1)) {
      const size_t end = std::min(kept.find("      - name: ", at + 1), kept.size());
      if (kept.substr(at, kept.find('\n', at) - at).ends_with(other)) kept.erase(at, end - at);
    }
    WriteWhole(data_ / "planes.yaml", kept);
    declare("planes.yaml");
    const Outcome outcome = Refine(data_);
    ASSERT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 2) << outcome.err;
    results[k] = Result();
    EXPECT_GE(results[k]["targets"].size(), 3U);
    double points = 0;
    for (const Json& target : results[k]["targets"]) points += target["points"].get<double>();
    EXPECT_GT(points, 70'000);  // the desk alone has 60,000
  }
  const bool told = results[0]["status"] != "ok" || results[1]["status"] != "ok";
  for (const char* name : {"M", "N"}) {
    const double apart = std::abs(ValueOf(results[0], name) - ValueOf(results[1], name));
    const double within = 1.96 * std::hypot(UOf(results[0], name), UOf(results[1], name));
    EXPECT_TRUE(told || apart < within) << name << ": " << apart << " apart, expected " << within;
  }
}

TEST_F(TiltingLidarTest, TheScanIsHashedOnce) {
  Refine(data_);
  const Json result = Result();
  ASSERT_EQ(result["inputs"].size(), 2U);
  EXPECT_EQ(result["inputs"][1]["file"], kScan);
}

}  // namespace
}  // namespace scancal
