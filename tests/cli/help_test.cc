// What the program says of itself, and to flags that it does not have.
#include <gmock/gmock.h>
#include <regex>
#include <set>
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

class FlagsTest : public CliTest {};

// The flags that a help text lists, in order.
std::vector<std::string> FlagsIn(const std::string& help) {
  std::vector<std::string> flags;
  const std::regex flag("^  --(\\w+)");
  for (const std::string& line : Lines(help)) {
    std::smatch match;
    if (std::regex_search(line, match, flag)) flags.push_back(match[1]);
  }
  return flags;
}

std::vector<std::string> HelpFlags(const std::string& command) {
  const Outcome outcome = RunScancal({command, "--help"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, HasSubstr("usage: scancal " + command));
  return FlagsIn(outcome.out);
}

TEST(HelpTest, WithoutArgumentsTheCommandsAreListed) {
  const Outcome outcome = RunScancal({});
  EXPECT_EQ(outcome.exit_code, 1);
  for (const char* command :
       {"refine", "montecarlo", "compare", "simulate", "transform", "propagate", "convert", "planes", "selftest"})
    EXPECT_THAT(outcome.out, HasSubstr("\n  " + std::string(command) + " "));
  EXPECT_THAT(outcome.out, Not(HasSubstr("--flagfile")));
}

TEST(HelpTest, HelpIsNoError) {
  const Outcome outcome = RunScancal({"--help"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.out, RunScancal({}).out);
  EXPECT_EQ(outcome.err, "");
}

TEST(HelpTest, VersionIsOneLine) {
  const Outcome outcome = RunScancal({"--version"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(std::regex_match(outcome.out, std::regex("scancal \\d+\\.\\d+\\.\\d+(, reads also [A-Z0-9a-z ,]+)?\n")))
      << outcome.out;
}

TEST(HelpTest, EachCommandShowsItsOwnFlagsOnly) {
  EXPECT_THAT(HelpFlags("refine"),
              ElementsAre("out", "report", "language", "residual", "weights", "max_iterations", "montecarlo", "wide",
                          "sign", "batch", "threads", "resume", "accept_unreliable"));
  EXPECT_THAT(HelpFlags("montecarlo"), ElementsAre("out", "report", "language", "trials", "seed", "digits", "threads",
                                                   "wide", "sign", "accept_unreliable"));
  EXPECT_THAT(HelpFlags("report"), ElementsAre("out", "pdf", "dcc", "figures", "previous", "language", "key"));
  EXPECT_THAT(HelpFlags("recheck"), ElementsAre("key", "sign"));
  EXPECT_THAT(HelpFlags("verify"), ElementsAre("at", "out", "unreliable", "key"));
  EXPECT_THAT(HelpFlags("diff"), ElementsAre("format", "unreliable", "key"));
  EXPECT_THAT(HelpFlags("history"), ElementsAre("format", "out", "language", "unreliable", "key"));
  EXPECT_THAT(HelpFlags("compare"), ElementsAre("steps", "surface", "wide"));
  EXPECT_THAT(HelpFlags("convert"), ElementsAre("as"));
  EXPECT_THAT(HelpFlags("planes"), ElementsAre("out"));
  EXPECT_THAT(HelpFlags("selftest"), ElementsAre("nist"));
  EXPECT_THAT(HelpFlags("transform"),
              UnorderedElementsAre("calibration", "out", "u", "covariance", "unreliable", "key"));
  EXPECT_THAT(HelpFlags("propagate"),
              UnorderedElementsAre("point", "points_file", "units", "distance", "out", "unreliable", "key"));
  EXPECT_THAT(
      HelpFlags("simulate"),
      UnorderedElementsAre(
          "out", "M", "N", "tilt_x", "tilt_y", "scale_y", "scale_z", "shear", "linearity", "encoder_cos1",
          "encoder_sin1", "encoder_cos2", "encoder_sin2", "expansion", "linearity_3", "lens_z2", "lens_yz", "lens_yz2",
          "range_offset", "range_scale", "encoder_scale", "back", "drift_sweep", "drift", "angle_step",
          "profile_offset", "profile_correlation", "placements", "profiles", "points", "sweep", "line_length", "noise",
          "line_correlation", "encoder_jitter", "form", "form_kind", "one_plate", "outliers", "background", "declare",
          "missing", "search_width_M", "search_width_N", "seed", "format", "model", "stations", "poses", "translations",
          "configuration", "ball_noise", "repeatability", "u_artifact", "check_positions", "planes", "artifact"));
}

TEST(HelpTest, FlagsHaveUnitsAndDefaults) {
  const std::string help = RunScancal({"simulate", "--help"}).out;
  for (const auto& [flag, unit, preset] :
       {std::tuple{"M", "mm", "123"}, std::tuple{"N", "mm", "409"}, std::tuple{"tilt_x", "deg", "0"},
        std::tuple{"sweep", "deg", "30"}, std::tuple{"line_length", "mm", "200"}, std::tuple{"noise", "mm", "0.05"},
        std::tuple{"encoder_jitter", "deg", "0"}, std::tuple{"line_correlation", "points", "1"}}) {
    const std::regex line(std::string("  --") + flag + "=double +.*\\b" + unit + "\\b.*\\(default " + preset + "\\)");
    EXPECT_TRUE(std::regex_search(help, line)) << flag << ": expected " << unit << ", default " << preset << "\n"
                                               << help;
  }
  EXPECT_THAT(RunScancal({"refine", "--help"}).out, AllOf(HasSubstr("(default depth)"), HasSubstr("(default 100)")));
}

TEST(HelpTest, AnUnknownCommandIsNamed) {
  const Outcome outcome = RunScancal({"refin"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(OneSentence(outcome), HasSubstr("\"refin\""));
}

TEST_F(FlagsTest, AnUnknownFlagIsNamed) {
  const Outcome outcome = Refine(MakeData(), {"--max_iteration=3"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("'max_iteration'"));
  EXPECT_EQ(Lines(outcome.err).size(), 1U) << outcome.err;
  EXPECT_FALSE(fs::exists(Path("out")));
}

TEST_F(FlagsTest, AFlagOfAnotherCommandIsRefused) {
  const fs::path data = MakeData();
  for (const char* flag : {"--sweep=20", "--sweep=30", "--surface=s.csv", "--calibration=c.json", "--seed=1"}) {
    const Outcome outcome = Refine(data, {flag});
    EXPECT_EQ(outcome.exit_code, 1) << flag;
    const std::string name = std::string(flag).substr(0, std::string(flag).find('='));
    EXPECT_THAT(OneSentence(outcome), AllOf(HasSubstr(name + " "), HasSubstr("refine")));
  }
  EXPECT_EQ(RunScancal({"compare", data.string(), "--max_iterations=3"}).exit_code, 1);
  EXPECT_EQ(RunScancal({"transform", data.string(), "--out=x.ply", "--residual=plane"}).exit_code, 1);
  EXPECT_EQ(RunScancal({"simulate", "--residual=plane", "--out=" + Path("x").string()}).exit_code, 1);
  EXPECT_FALSE(fs::exists(Path("x")));
  EXPECT_FALSE(fs::exists(Path("out")));
}

TEST_F(FlagsTest, AMissingOrSecondArgumentIsRefused) {
  const std::string data = MakeData().string();
  for (const char* command : {"refine", "montecarlo", "compare"}) {
    const Outcome none = RunScancal({command}), two = RunScancal({command, data, data});
    EXPECT_EQ(none.exit_code, 1);
    EXPECT_EQ(two.exit_code, 1);
    EXPECT_THAT(OneSentence(none), AllOf(HasSubstr("found 0 arguments"), HasSubstr("the folder of a data set")));
    EXPECT_THAT(OneSentence(two), HasSubstr("found 2 arguments"));
  }
  EXPECT_THAT(OneSentence(RunScancal({"transform", data})), HasSubstr("--out: expected a file name that ends in .ply"));
  EXPECT_THAT(OneSentence(RunScancal({"transform", "--out=x.ply"})), HasSubstr("found 0 arguments"));
  EXPECT_THAT(OneSentence(RunScancal({"simulate"})), HasSubstr("--out: expected the folder"));
  EXPECT_THAT(OneSentence(RunScancal({"simulate", data})), HasSubstr("takes no argument"));
}

TEST_F(FlagsTest, AFlagWithAWrongValueIsRefused) {
  const fs::path data = MakeData();
  const std::string out = "--out=" + Path("x").string();
  EXPECT_THAT(OneSentence(Refine(data, {"--residual=deep"})),
              AllOf(HasSubstr("\"deep\""), HasSubstr("depth or plane")));
  EXPECT_THAT(OneSentence(Refine(data, {"--max_iterations=0"})), HasSubstr("--max_iterations: expected 1 or more"));
  for (const char* trials : {"99", "-1", "200000000"})
    EXPECT_THAT(OneSentence(Refine(data, {std::string("--montecarlo=") + trials})),
                AllOf(HasSubstr(std::string("--montecarlo: found ") + trials), HasSubstr("100 to 10000000 trials")));
  for (const auto& [flag, value, expected] :
       {std::tuple{"trials", "0", "100 to 10000000"}, std::tuple{"digits", "3", "1 or 2"},
        std::tuple{"threads", "-1", "0 (one for every core) to 1000"}}) {
    const Outcome outcome = RunScancal({"montecarlo", data.string(), out, std::string("--") + flag + "=" + value});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(OneSentence(outcome), AllOf(HasSubstr(std::string(flag) + ": found " + value), HasSubstr(expected)));
  }
  EXPECT_THAT(OneSentence(RunScancal({"simulate", out, "--format=xls"})),
              AllOf(HasSubstr("\"xls\""), HasSubstr("csv or npy")));
  for (const char* flag : {"--profiles=0", "--points=-1", "--placements=0", "--sweep=180", "--sweep=-1", "--noise=-1",
                           "--noise=nan", "--outliers=1", "--missing=-0.1", "--line_length=0", "--line_correlation=0.5",
                           "--search_width_M=0", "--M=nan", "--N=inf", "--tilt_x=nan"}) {
    const Outcome outcome = RunScancal({"simulate", out, "--profiles=3", "--points=3", flag});
    EXPECT_EQ(outcome.exit_code, 1) << flag;
    const std::string name = std::string(flag).substr(2, std::string(flag).find('=') - 2);
    EXPECT_EQ(Lines(outcome.err).size(), 1U) << flag << ": " << outcome.err;
    EXPECT_FALSE(fs::exists(Path("x"))) << flag;
    fs::remove_all(Path("x"));
  }
  EXPECT_THAT(RunScancal({"simulate", out, "--profiles=many"}).err,
              AllOf(HasSubstr("'many'"), HasSubstr("'profiles'")));
  EXPECT_FALSE(fs::exists(Path("x")));
}

}  // namespace
}  // namespace scancal
