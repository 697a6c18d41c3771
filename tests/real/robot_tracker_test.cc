// A real arm seen by a tracker: poses that were held out, and whether parts of its data agree within what they state.
#include <gmock/gmock.h>
#include <utility>
#include "tests/cli/data_set.h"
#include "tests/real/data_sets.h"

namespace scancal {
namespace {

class Irb120Test : public CliTest {
 protected:
  void SetUp() override {
    const fs::path data = DataSets() / "irb120-faro";
    if (!fs::exists(data / "points.csv"))
      GTEST_SKIP() << "NOT TESTED ON REAL DATA: there is no " << data
                   << "; set SCANCAL_DATASETS to the folder that holds irb120-faro/";
    fs::create_directory_symlink(fs::canonical(data), Path("irb120-faro"));
    yaml_ = ReadWhole(fs::path(SCANCAL_SOURCE_DIR) / "tests" / "real" / "irb120-faro" / "dataset.yaml");
  }

  // Mean distance of the reflectors at the poses held out, mm: with the nominal links, and with the calibrated ones.
  std::pair<double, double> HeldOut(const std::string& influences) {
    WriteWhole(Path("dataset.yaml"), yaml_ + influences);
    const Outcome outcome = Refine(Path("dataset.yaml"));
    EXPECT_NE(outcome.exit_code, 1) << ::testing::PrintToString(outcome);
    const Json check = Result()["check"];
    return {check["before"]["errors"][0], check["after"]["errors"][0]};
  }

  std::string yaml_;
};

// A plain fit of the same model (plain_fit.py: scipy, unit weights, every pose) gives 0.479 and 0.389 mm at the same
// poses.
TEST_F(Irb120Test, PosesHeldOutAreHitAsWellAsByAPlainFit) {
  const auto [nominal, links] = HeldOut("");
  EXPECT_GT(nominal, 0.75);
  EXPECT_LT(links, 0.479);
  const double gravity = HeldOut("influences: {gravity: estimate}\n").second;
  EXPECT_LT(gravity, 1.02 * 0.389);
  EXPECT_LT(HeldOut("influences: {gravity: estimate, joint_scale: estimate}\n").second, 0.38);
}

}  // namespace
}  // namespace scancal
