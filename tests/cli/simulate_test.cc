// simulate, then refine: the truth comes back.
#include <gmock/gmock.h>
#include "io/units.h"
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class SimulateTest : public CliTest {
 protected:
  fs::path Simulated(std::vector<std::string> flags, const std::string& name = "data") const {
    flags.insert(flags.begin(), {"--profiles=40", "--points=20"});
    Simulate(Path(name), flags);
    return Path(name);
  }
};

TEST_F(SimulateTest, NoiselessDataGiveTheTruth) {
  const Json result = Refined(Simulated({"--noise=0", "--format=npy"}));
  EXPECT_NEAR(ValueOf(result, "M"), 123, 1e-9);  // mm
  EXPECT_NEAR(ValueOf(result, "N"), 409, 1e-9);
}

TEST_F(SimulateTest, NoiselessDataGiveTheTruthElsewhere) {
  for (const auto& [M, N] : {std::pair{"-57.25", "310.5"}, std::pair{"0", "409"}, std::pair{"12.5", "-150.75"}}) {
    fs::remove_all(Path("data"));
    const fs::path data = Simulated({"--noise=0", "--format=npy", "--M=" + std::string(M), "--N=" + std::string(N)});
    const Json result = Refined(data);
    EXPECT_NEAR(ValueOf(result, "M"), std::stod(M), 1e-9);
    EXPECT_NEAR(ValueOf(result, "N"), std::stod(N), 1e-9);
  }
}

TEST_F(SimulateTest, NoiselessDataGiveTheTilts) {
  const fs::path data = Simulated({"--noise=0", "--format=npy", "--tilt_x=0.4", "--tilt_y=-0.7"});
  Append(data / "dataset.yaml", "parameters: {tilt_x: estimate, tilt_y: estimate}\n");
  const Json result = Refined(data);
  EXPECT_NEAR(ValueOf(result, "M"), 123, 1e-8);
  EXPECT_NEAR(ValueOf(result, "N"), 409, 1e-8);
  EXPECT_NEAR(ValueOf(result, "tilt_x"), 0.4 * kDegree, 1e-11);  // rad
  EXPECT_NEAR(ValueOf(result, "tilt_y"), -0.7 * kDegree, 1e-11);
}

TEST_F(SimulateTest, CsvRoundsToLessThanItsOwnUncertainty) {
  const Json result = Refined(Simulated({"--noise=0"}));
  EXPECT_LT(UOf(result, "M"), 2e-4);  // digits of 0.1 um
  EXPECT_NEAR(ValueOf(result, "M"), 123, 4 * UOf(result, "M"));
  EXPECT_NEAR(ValueOf(result, "N"), 409, 4 * UOf(result, "N"));
}

TEST_F(SimulateTest, NoisyDataGiveTheTruthWithinTheirUncertainty) {
  int within = 0;
  for (int seed = 1; seed <= 10; ++seed) {
    fs::remove_all(Path("data"));
    const Json result = Refined(Simulated({"--seed=" + std::to_string(seed)}));
    for (const auto& [name, truth] : {std::pair{"M", 123.0}, std::pair{"N", 409.0}}) {
      const double u = UOf(result, name), error = ValueOf(result, name) - truth;
      EXPECT_LT(std::abs(error), 4 * u);
      within += std::abs(error) < u;
    }
  }
  EXPECT_GE(within, 7);  // of 20, of which 68 % are expected; fewer than 8 are seen once in a thousand
}

TEST_F(SimulateTest, TheSameSeedGivesTheSameFiles) {
  const std::vector<std::string> flags = {"--seed=7", "--encoder_jitter=0.01", "--outliers=0.01", "--missing=0.01",
                                          "--form=0.01"};
  const fs::path first = Simulated(flags, "first"), second = Simulated(flags, "second");
  const fs::path other =
      Simulated({"--seed=8", "--encoder_jitter=0.01", "--outliers=0.01", "--missing=0.01", "--form=0.01"}, "other");
  for (const char* file : {"left.csv", "centre.csv", "right.csv", "truth.json", "dataset.yaml"}) {
    ASSERT_GT(ReadWhole(first / file).size(), 100U) << file;
    EXPECT_EQ(ReadWhole(first / file), ReadWhole(second / file)) << file;
    EXPECT_NE(ReadWhole(first / file), ReadWhole(other / file)) << file;
  }
}

TEST_F(SimulateTest, TheSampleIsWhatItsSeedMakes) {
  const fs::path sample = fs::path(SCANCAL_SOURCE_DIR) / "data" / "sample";
  const auto truth = ReadJson(sample / "truth.json");
  ASSERT_TRUE(truth.ok()) << truth.error().message;
  Simulate(Path("sample"), {"--seed=" + std::to_string((*truth)["seed"].get<int>()), "--outliers=0.002",
                            "--missing=0.005", "--encoder_jitter=0.002"});
  for (const char* file : {"left.csv", "centre.csv", "right.csv", "dataset.yaml", "truth.json"})
    EXPECT_TRUE(ReadWhole(sample / file) == ReadWhole(Path("sample") / file)) << file;
}

TEST_F(SimulateTest, WhatWasSimulatedMayBeDeclared) {
  const fs::path data = Simulated({"--noise=0.04", "--encoder_jitter=0.002", "--form=0.005", "--declare"});
  EXPECT_THAT(ReadWhole(data / "dataset.yaml"),
              HasSubstr("\ninfluences: {noise_y: 0.04, encoder_jitter: 0.002, form: 0.005, one_plate: no}\n"));
  EXPECT_NE(Refine(data).exit_code, 1);
  const fs::path none = Simulated({"--noise=0", "--declare"}, "none");
  EXPECT_THAT(ReadWhole(none / "dataset.yaml"), Not(HasSubstr("influences")));
}

TEST_F(SimulateTest, FormIsOfItsKind) {
  const fs::path modes = Simulated({"--form=0.01", "--one_plate"}, "modes"),
                 smooth = Simulated({"--form=0.01", "--form_kind=smooth"}, "smooth");
  EXPECT_NE(ReadWhole(modes / "left.csv"), ReadWhole(smooth / "left.csv"));
  EXPECT_EQ((*ReadJson(modes / "truth.json"))["form_kind"], "modes");
  EXPECT_EQ((*ReadJson(modes / "truth.json"))["one_plate"], true);
  EXPECT_EQ((*ReadJson(smooth / "truth.json"))["form_kind"], "smooth");
  EXPECT_THAT(OneSentence(RunScancal({"simulate", "--form_kind=rough", "--out=" + Path("x").string()})),
              HasSubstr("--form_kind: found \"rough\", expected modes, smooth or bent"));
}

TEST_F(SimulateTest, TheSampleGivesItsTruth) {
  const Json result = Refined(fs::path(SCANCAL_SOURCE_DIR) / "data" / "sample");
  EXPECT_NEAR(ValueOf(result, "M"), 123, 4 * UOf(result, "M"));
  EXPECT_NEAR(ValueOf(result, "N"), 409, 4 * UOf(result, "N"));
  EXPECT_LT(UOf(result, "M"), 0.05);
}

TEST_F(SimulateTest, SpikesAndGapsAreCounted) {
  const Json result = Refined(Simulated({"--outliers=0.05", "--missing=0.1"}));
  double points = 0, missing = 0, set_aside = 0;
  for (const Json& target : result["targets"]) {
    points += target["points"].get<double>();
    missing += target["missing"].get<double>();
    set_aside += target["set_aside"].get<double>();
  }
  EXPECT_EQ(points + missing + set_aside, 2400);
  EXPECT_NEAR(missing, 240, 60);
  EXPECT_NEAR(set_aside, 0.9 * 120, 40);
  EXPECT_NEAR(ValueOf(result, "N"), 409, 4 * UOf(result, "N"));
}

TEST_F(SimulateTest, PathsMayHaveBlanksAndQuotes) {
  const std::string name = "the plate's \"best\" data; $HOME & more";
  const Outcome outcome = Refine(Simulated({}, name));
  EXPECT_EQ(outcome.exit_code, 0) << ::testing::PrintToString(outcome);
  EXPECT_THAT(Result()["command"].get<std::string>(), AllOf(HasSubstr("refine"), HasSubstr("best")));
}

TEST_F(SimulateTest, MissingFoldersAreMade) {
  const fs::path data = Simulated({}, "one/two/three");
  const Outcome outcome = RunScancal({"refine", data.string(), "--out=" + Path("four/five").string()});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(fs::exists(Path("four/five/calibration.json")));
}

TEST_F(SimulateTest, WithoutOutTheCurrentFolderIsWritten) {
  const fs::path data = Simulated({});
  fs::create_directory(Path("here"));
  const Outcome outcome = RunScancal({"refine", "../data"}, {.folder = Path("here"), .largest_file = {}});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(fs::exists(Path("here/calibration.json")));
}

TEST_F(SimulateTest, AProfilerThatLooksPastThePlateIsRefused) {
  const Outcome outcome = RunScancal({"simulate", "--sweep=170", "--out=" + Path("x").string()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(OneSentence(outcome), AllOf(HasSubstr("looks past the plate"), HasSubstr("use a narrower sweep")));
  EXPECT_FALSE(fs::exists(Path("x")));
}

}  // namespace
}  // namespace scancal
