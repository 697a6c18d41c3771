// simulate --model=robot-ball, then refine: the truth comes back.
#include <gmock/gmock.h>
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class SimulateRobotTest : public CliTest {
 protected:
  fs::path Simulated(std::vector<std::string> flags, const std::string& name = "data") const {
    flags.insert(flags.begin(), {"--model=robot-ball"});
    Simulate(Path(name), flags);
    return Path(name);
  }
};

const std::vector<std::string> kFiles = {"dataset.yaml", "poses.csv",       "balls.csv",           "artifact.csv",
                                         "truth.json",   "check_poses.csv", "check_distances.csv", "check_balls.csv"};

// The artifact's 10 nm hide that its file is rounded to 1 nm, which is no noise and would be found out.
TEST_F(SimulateRobotTest, NearlyNoiselessDataGiveTheTruth) {
  const fs::path data = Simulated({"--ball_noise=0", "--repeatability=0", "--u_artifact=1e-5"});
  const Json result = Refined(data), truth = (*ReadJson(data / "truth.json"))["as_default_roles_find_it"];
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      EXPECT_NEAR(result["hand_eye"][i][j].get<double>(), truth["hand_eye"][i][j].get<double>(), j == 3 ? 1e-4 : 1e-6);
  int links = 0;
  for (const auto& parameter : result["parameters"]) {
    const std::string name = parameter["name"];
    if (!truth["link_errors"].contains(name)) continue;
    ++links;
    EXPECT_NEAR(parameter["value"].get<double>(), truth["link_errors"][name].get<double>(),
                parameter["unit"] == "mm" ? 1e-4 : 1e-6)
        << name;
  }
  EXPECT_GE(links, 18);
}

TEST_F(SimulateRobotTest, TheSameSeedGivesTheSameFiles) {
  const fs::path one = Simulated({"--seed=7"}, "one"), again = Simulated({"--seed=7"}, "again"),
                 other = Simulated({"--seed=8"}, "other");
  for (const std::string& file : kFiles) {
    EXPECT_FALSE(ReadWhole(one / file).empty()) << file;
    EXPECT_EQ(ReadWhole(one / file), ReadWhole(again / file)) << file;
  }
  EXPECT_NE(ReadWhole(one / "balls.csv"), ReadWhole(other / "balls.csv"));
}

TEST_F(SimulateRobotTest, DeclaresItsNoiseOnDemand) {
  EXPECT_THAT(ReadWhole(Simulated({"--declare"}) / "dataset.yaml"),
              HasSubstr("influences: {ball: 0.035, repeatability: 0.04}\n"));
  EXPECT_THAT(ReadWhole(Simulated({}, "silent") / "dataset.yaml"), ::testing::Not(HasSubstr("influences")));
}

TEST_F(SimulateRobotTest, WrongFlagsAreRefused) {
  const std::string out = "--out=" + Path("x").string();
  const auto refused = [&](std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"simulate", out});
    return OneSentence(RunScancal(flags));
  };
  EXPECT_THAT(refused({"--model=robot"}),
              AllOf(HasSubstr("\"robot\""), HasSubstr("turntable, robot-ball or robot-profiler")));
  EXPECT_THAT(refused({"--poses=4"}), AllOf(HasSubstr("--poses"), HasSubstr("--model=robot-ball")));
  EXPECT_THAT(refused({"--model=robot-ball", "--sweep=20"}), AllOf(HasSubstr("--sweep"), HasSubstr("turntable")));
  EXPECT_THAT(refused({"--model=robot-ball", "--configuration=flat"}), HasSubstr("spatial, planar or collinear"));
  EXPECT_THAT(refused({"--model=robot-ball", "--stations=0"}), HasSubstr("one or more"));
  EXPECT_FALSE(fs::exists(Path("x")));
}

}  // namespace
}  // namespace scancal
