// NIST's certified nonlinear regressions, by the program itself.
#include <gmock/gmock.h>
#include "tests/cli/data_set.h"
#include "tests/real/data_sets.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class NistTest : public CliTest {
 protected:
  void SetUp() override {
    if (!fs::exists(nist_ / "Bennett5.dat"))
      GTEST_SKIP() << "NOT TESTED ON NIST'S REGRESSIONS: there is no " << nist_
                   << "; set SCANCAL_DATASETS to the folder that holds nist-strd/";
  }
  // The files, to be damaged.
  fs::path Copy() const {
    fs::copy(nist_, Path("nist"));
    fs::permissions(Path("nist") / "Misra1a.dat", fs::perms::owner_write, fs::perm_options::add);
    return Path("nist");
  }
  const fs::path nist_ = DataSets() / "nist-strd";
};

TEST_F(NistTest, AllTwentySevenPass) {
  const Outcome outcome = RunScancal({"selftest", "--nist=" + nist_.string()});
  EXPECT_EQ(outcome.exit_code, 0) << ::testing::PrintToString(outcome);
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("34 of 34 cases passed\nselftest: pass\n"),
                                 HasSubstr("Lanczos1: its residual"), Not(HasSubstr("FAIL"))));
}

TEST_F(NistTest, AWrongCertifiedDigitFails) {
  const fs::path folder = Copy();
  Replace(folder / "Misra1a.dat", "2.3894212918E+02", "2.3894213918E+02");
  const Outcome outcome = RunScancal({"selftest", "--nist=" + folder.string()});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.out, HasSubstr("33 of 34 cases passed\nselftest: FAIL\n"));
  for (const std::string& line : Lines(outcome.out)) EXPECT_EQ(line.starts_with("Misra1a"), line.ends_with("  FAIL"));
}

TEST_F(NistTest, ADamagedFileIsRefused) {
  const fs::path folder = Copy();
  Replace(folder / "Misra1a.dat", "10.07E0", "10,07E0");
  const Outcome outcome = RunScancal({"selftest", "--nist=" + folder.string()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(OneSentence(outcome),
              AllOf(HasSubstr("Misra1a.dat:61: found \"10,07E0"), HasSubstr("expected 2 numbers")));
}

TEST_F(NistTest, AMissingFileIsNamed) {
  const fs::path folder = Copy();
  fs::remove(folder / "Misra1a.dat");
  const Outcome outcome = RunScancal({"selftest", "--nist=" + folder.string()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(OneSentence(outcome), AllOf(HasSubstr("found 26 of the 27"), HasSubstr("missing .dat files: Misra1a")));
}

}  // namespace
}  // namespace scancal
