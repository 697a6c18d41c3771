// scancal verify: an artifact that took no part.
#include <gmock/gmock.h>
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class VerifyTest : public CliTest {
 protected:
  VerifyTest() {
    Simulate(data_, {"--profiles=40", "--points=20", "--declare", "--artifact", "--encoder_jitter=0.002"});
    Append(data_ / "dataset.yaml", "parameters: {scale_y: {consider: 0, u: 2e-4}}\n");
    Refined(data_);
  }
  Outcome Verify(std::vector<std::string> flags = {}) const {
    flags.insert(flags.begin(), {"verify", calibration_.string(), verify_.string()});
    return RunScancal(flags);
  }
  std::string Refusal(const std::vector<std::string>& flags = {}) const {
    const Outcome outcome = Verify(flags);
    EXPECT_EQ(outcome.exit_code, 1) << ::testing::PrintToString(outcome);
    EXPECT_EQ(outcome.out, "");
    return OneSentence(outcome);
  }

  const fs::path data_ = Path("data"), verify_ = Path("data") / "artifact" / "verify.yaml",
                 calibration_ = Path("out") / "calibration.json";
};

TEST_F(VerifyTest, FeaturesAgreeAndWithOtherParametersTheyDoNot) {
  const Outcome right = Verify({"--out=" + Path("f.csv").string()});
  EXPECT_EQ(right.exit_code, 0) << ::testing::PrintToString(right);
  EXPECT_EQ(right.err, "");
  EXPECT_THAT(right.out, AllOf(HasSubstr("all 3 features agree"), HasSubstr("accept"), HasSubstr("planes cannot see")));
  const std::vector<std::string> rows = Lines(ReadWhole(Path("f.csv")));
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_THAT(rows[2], HasSubstr("bar,,distance,"));
  const Outcome moved = Verify({"--at=M:123,N:379"});
  EXPECT_EQ(moved.exit_code, 2) << ::testing::PrintToString(moved);
  EXPECT_THAT(moved.out, AllOf(HasSubstr("with M:123,N:379, not as calibrated"), HasSubstr("reject")));
}

TEST_F(VerifyTest, WrongInputIsRefused) {
  EXPECT_THAT(Refusal({"--at=M:x"}), HasSubstr("--at: found \"M:x\""));
  EXPECT_THAT(Refusal({"--at=m:120"}), HasSubstr("expected parameters and values"));
  const std::string whole = ReadWhole(verify_);
  const auto refused = [&](const std::string& from, const std::string& to) {
    WriteWhole(verify_, whole);
    Replace(verify_, from, to);
    return Refusal();
  };
  EXPECT_THAT(refused("diameter: A", "diameter: C"), HasSubstr("no target of this name"));
  EXPECT_THAT(refused("diameter: A", "length: A"), HasSubstr("expected one of diameter"));
  EXPECT_THAT(refused("[A, B]", "[A]"), HasSubstr("the names of two targets"));
  EXPECT_THAT(refused("nominal: 25.4", "nominal: -1"), HasSubstr("the value on the certificate"));
  EXPECT_THAT(refused("tolerance: 0.3", "tolerance: 0"), HasSubstr("expected more than 0"));
  EXPECT_THAT(refused("diameter: A,", "diameter: A, colour: red,"), HasSubstr("colour"));
  EXPECT_THAT(refused("rotation: clockwise", "rotation: counterclockwise"), HasSubstr("rotation is"));
  EXPECT_THAT(refused("scan: A.csv", "scan: Z.csv"), HasSubstr("Z.csv: no such file"));
  EXPECT_THAT(refused("features:", "other:"), HasSubstr("features"));
}

}  // namespace
}  // namespace scancal
