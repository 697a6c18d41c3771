// scancal montecarlo, and the flag of refine.
#include <gmock/gmock.h>
#include <numeric>
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::Eq;
using ::testing::HasSubstr;

class MonteCarloTest : public CliTest {
 protected:
  // Its part of calibration.json.
  Json MonteCarlo(std::vector<std::string> flags) const {
    flags.insert(flags.begin(), {"montecarlo", data_.string(), "--out=" + Path("out").string()});
    const Outcome outcome = RunScancal(flags);
    EXPECT_EQ(outcome.exit_code, 0) << ::testing::PrintToString(outcome);
    EXPECT_EQ(outcome.err, "");  // no bar where there is no terminal
    return Result()["montecarlo"];
  }
  const fs::path data_ = MakeData();
};

TEST_F(MonteCarloTest, IsWrittenAndPrinted) {
  const Json json = MonteCarlo({"--trials=400", "--seed=7"});
  EXPECT_EQ(json["trials"], 400);
  EXPECT_EQ(json["failed"], 0);
  EXPECT_EQ(json["seed"], 7);
  EXPECT_EQ(json["digits"], 1);
  ASSERT_EQ(json["parameters"].size(), 2u);
  const Json calibration = Result();
  for (const Json& p : json["parameters"]) {
    const double value = ValueOf(calibration, p["name"]), u = UOf(calibration, p["name"]);
    // White noise that was declared; u from the scatter of 120 profiles is known to 7 %.
    EXPECT_NEAR(p["mean"], value, 4 * u / 20);
    EXPECT_NEAR(p["u"], u, 0.4 * u);
    EXPECT_NEAR(p["high"].get<double>() - p["low"].get<double>(), 4 * u, 1.6 * u);
    EXPECT_NEAR(p["gum_high"].get<double>() - p["gum_low"].get<double>(),
                2 * ParameterOf(calibration, p["name"])["U"].get<double>(), 1e-9);
    EXPECT_THAT(p["verdict"].get<std::string>(), AnyOf(Eq("PASS"), Eq("FAIL"), Eq("UNDECIDED")));
    const auto counts = p["histogram"]["counts"].get<std::vector<double>>();
    EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0.0), 400);
  }
  const Outcome outcome = RunScancal({"montecarlo", data_.string(), "--trials=100", "--out=" + Path("out").string()});
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("Monte Carlo: 100 trials, seed 1;"), HasSubstr("status: ok")));
}

TEST_F(MonteCarloTest, GivesTheSameDigitsForAnyThreads) {
  const Json one = MonteCarlo({"--trials=150", "--threads=1"});
  EXPECT_EQ(MonteCarlo({"--trials=150", "--threads=2"}), one);
  EXPECT_EQ(MonteCarlo({"--trials=150"}), one);
  EXPECT_NE(MonteCarlo({"--trials=150", "--seed=2"}), one);
  Refined(data_, 0, {"--montecarlo=150"});
  EXPECT_EQ(Result()["montecarlo"], one);
  Refined(data_);
  EXPECT_EQ(Result()["montecarlo"], Json::object());
}

TEST_F(MonteCarloTest, TakesNoMoreTrialsThanGivenAtTwoDigits) {
  const Json json = MonteCarlo({"--digits=2", "--trials=1000"});
  EXPECT_EQ(json["trials"], 1000);
  EXPECT_EQ(json["digits"], 2);
  EXPECT_EQ(json["stable"], false);
  for (const Json& p : json["parameters"]) EXPECT_NE(p["verdict"], "PASS");
}

}  // namespace
}  // namespace scancal
