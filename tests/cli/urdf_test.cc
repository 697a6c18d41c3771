// scancal urdf: a calibrated robot as a URDF, and that as the nominal robot of the same data.
#include <gmock/gmock.h>
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::HasSubstr;

class UrdfTest : public CliTest {
 protected:
  fs::path Simulated() const {
    Simulate(Path("data"), {"--model=robot-ball", "--stations=5"});
    return Path("data");
  }
  Outcome Urdf() const {
    return RunScancal({"urdf", (Path("out") / "calibration.json").string(), "--out=" + Path("arm.urdf").string()});
  }
};

TEST_F(UrdfTest, WhatIsWrittenIsReadBackAsTheNominalRobot) {
  const fs::path data = Simulated();
  const Json first = Refined(data);
  const Outcome written = Urdf();
  ASSERT_EQ(written.exit_code, 0) << ::testing::PrintToString(written);
  EXPECT_THAT(written.out, HasSubstr("wrote 6 joints, base_link to flange"));
  EXPECT_THAT(ReadWhole(Path("arm.urdf")), HasSubstr("<link name=\"scanner\"/>"));
  fs::rename(Path("arm.urdf"), data / "arm.urdf");
  std::string yaml = ReadWhole(data / "dataset.yaml");
  const size_t from = yaml.find("robot:\n"), to = yaml.find("poses: ");
  ASSERT_LT(from, to);
  WriteWhole(data / "dataset.yaml", yaml.replace(from, to - from, "robot: {urdf: arm.urdf, tip: flange}\n"));
  const Json second = Refined(data);
  int links = 0;
  for (const Json& parameter : second["parameters"]) {
    if (!parameter.contains("nominal") || parameter["role"] != "estimate") continue;
    ++links;  // what is left to be found of a robot that was calibrated with these data
    EXPECT_LT(std::abs(parameter["value"].get<double>()), 0.01 * parameter["u"].get<double>()) << parameter["name"];
  }
  EXPECT_EQ(links, 18);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j)
      EXPECT_NEAR(second["hand_eye"][i][j].get<double>(), first["hand_eye"][i][j].get<double>(), j == 3 ? 1e-3 : 1e-5);
  EXPECT_NEAR(second["check"]["after"]["mean"].get<double>(), first["check"]["after"]["mean"].get<double>(), 1e-3);
}

TEST_F(UrdfTest, WhatAUrdfCannotSayIsLeftOutAndNamed) {
  const fs::path data = Simulated();
  Append(data / "dataset.yaml", "influences: {backlash_2: estimate}\n");
  Refined(data);
  const Outcome written = Urdf();
  EXPECT_EQ(written.exit_code, 0);
  EXPECT_THAT(written.err, HasSubstr("left out: backlash_2"));
  EXPECT_THAT(ReadWhole(Path("arm.urdf")), HasSubstr("<!-- joints of a URDF turn by what they read"));
}

}  // namespace
}  // namespace scancal
