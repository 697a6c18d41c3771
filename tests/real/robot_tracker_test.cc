// A real arm seen by a tracker: poses that were held out, and whether parts of its data agree within what they state.
#include <gmock/gmock.h>
#include <utility>
#include "tests/cli/data_set.h"
#include "tests/real/data_sets.h"

namespace scancal {
namespace {

class ArmTest : public CliTest {
 protected:
  // dataset: its folder in tests/real; folder: of the recordings.
  ArmTest(std::string dataset, std::string folder) : dataset_(std::move(dataset)), folder_of_data_(std::move(folder)) {}
  void SetUp() override {
    const fs::path data = DataSets() / folder_of_data_;
    if (!fs::exists(data))
      GTEST_SKIP() << "NOT TESTED ON REAL DATA: there is no " << data
                   << "; set SCANCAL_DATASETS to the folder that holds " << folder_of_data_;
    fs::create_directory_symlink(fs::canonical(data), Path(folder_of_data_));
    yaml_ = ReadWhole(fs::path(SCANCAL_SOURCE_DIR) / "tests" / "real" / dataset_ / "dataset.yaml");
  }

  // Mean distance of what was seen at the poses held out, mm: with the nominal links, and with the calibrated ones.
  std::pair<double, double> HeldOut(const std::string& influences) {
    WriteWhole(Path("dataset.yaml"), yaml_ + influences);
    const Outcome outcome = Refine(Path("dataset.yaml"));
    EXPECT_NE(outcome.exit_code, 1) << ::testing::PrintToString(outcome);
    const Json check = Result()["check"];
    return {check["before"]["errors"][0], check["after"]["errors"][0]};
  }

  std::string dataset_, folder_of_data_, yaml_;
};

class Irb120Test : public ArmTest {
 protected:
  Irb120Test() : ArmTest("irb120-faro", "irb120-faro") {}
};

class Ur10Test : public ArmTest {
 protected:
  Ur10Test() : ArmTest("ur10-ipa", "ipa-robot-accuracy") {}
};

// A plain fit of the same model (tests/real/plain_fit.py: scipy, unit weights, every pose) gives 0.479 and 0.389 mm at
// the same poses.
TEST_F(Irb120Test, PosesHeldOutAreHitAsWellAsByAPlainFit) {
  const auto [nominal, links] = HeldOut("");
  EXPECT_GT(nominal, 0.75);
  EXPECT_LT(links, 0.479);
  const double gravity = HeldOut("influences: {gravity: estimate}\n").second;
  EXPECT_LT(gravity, 1.04 * 0.389);
  EXPECT_LT(HeldOut("influences: {gravity: estimate, joint_scale: estimate}\n").second, 0.38);
}

// From its own file, without a converter. A plain fit gives 1.337 with nominal links, then 0.420 and 0.366 mm.
TEST_F(Ur10Test, PosesHeldOutAreHitAsWellAsByAPlainFit) {
  const auto [nominal, links] = HeldOut("");
  EXPECT_NEAR(nominal, 1.337, 0.05);
  EXPECT_LT(links, 0.420);
  EXPECT_LT(HeldOut("influences: {gravity: estimate}\n").second, 0.366);
}

}  // namespace
}  // namespace scancal
