// The program's own proof of its arithmetic.
#include <gmock/gmock.h>
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class SelftestTest : public CliTest {};

TEST_F(SelftestTest, PassesWithoutAnyFile) {
  const Outcome outcome = RunScancal({"selftest"}, {folder_.path(), {}});
  EXPECT_EQ(outcome.exit_code, 0) << ::testing::PrintToString(outcome);
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("--nist=FOLDER"), HasSubstr("\n7 of 7 cases passed\nselftest: pass\n")));
}

TEST_F(SelftestTest, AFolderWithoutTheFilesIsRefused) {
  for (const fs::path& folder : {folder_.path(), Path("nowhere")}) {
    const Outcome outcome = RunScancal({"selftest", "--nist=" + folder.string()});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(OneSentence(outcome), AllOf(HasSubstr(folder.string() + ": found 0 of the 27"), HasSubstr("Bennett5")));
  }
}

TEST_F(SelftestTest, AFileOfAnotherKindIsRefused) {
  for (const char* name :
       {"Bennett5", "BoxBOD",  "Chwirut1", "Chwirut2", "DanWood",  "ENSO",     "Eckerle4", "Gauss1",   "Gauss2",
        "Gauss3",   "Hahn1",   "Kirby2",   "Lanczos1", "Lanczos2", "Lanczos3", "MGH09",    "MGH10",    "MGH17",
        "Misra1a",  "Misra1b", "Misra1c",  "Misra1d",  "Nelson",   "Rat42",    "Rat43",    "Roszman1", "Thurber"})
    WriteWhole(Path(std::string(name) + ".dat"), "angle,y,z\n1,2,3\n");
  const Outcome outcome = RunScancal({"selftest", "--nist=" + folder_.path().string()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(OneSentence(outcome),
              AllOf(HasSubstr("Bennett5.dat: found no \"Starting Values"), HasSubstr("expected")));
}

TEST_F(SelftestTest, TakesNoArgument) {
  const Outcome outcome = RunScancal({"selftest", folder_.path().string()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(OneSentence(outcome), HasSubstr("--nist"));
}

}  // namespace
}  // namespace scancal
