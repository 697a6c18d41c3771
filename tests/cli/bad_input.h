// A data set to be damaged: refused with exit code 1, one sentence with the place, and the old result untouched.
#pragma once
#include <gmock/gmock.h>
#include "tests/cli/data_set.h"

namespace scancal {

class BadInputTest : public CliTest {
 protected:
  BadInputTest() {
    fs::create_directories(Path("out"));
    WriteWhole(Path("out") / "calibration.json", kOld);
  }

  void ExpectRefused(const ::testing::Matcher<std::string>& sentence) const {
    const Outcome outcome = Refine(data_);
    EXPECT_EQ(outcome.exit_code, 1) << ::testing::PrintToString(outcome);
    EXPECT_THAT(OneSentence(outcome), sentence);
    std::vector<std::string> left;
    for (const auto& entry : fs::directory_iterator(Path("out"))) left.push_back(entry.path().filename());
    EXPECT_THAT(left, ::testing::ElementsAre("calibration.json"));
    EXPECT_EQ(ReadWhole(Path("out") / "calibration.json"), kOld);
  }

  // What the data set says without damage; refines it into `out`, which is then the old result again.
  Json Undamaged() const {
    Json result = Refined(MakeData("undamaged"));
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

}  // namespace scancal
