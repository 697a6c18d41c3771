// scancal diff, scancal history: calibrations of one instrument against each other.
#include <gmock/gmock.h>
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class DiffTest : public CliTest {
 protected:
  // A calibration in folder_/name, of an instrument with this M.
  std::string Calibrated(const std::string& name, int seed, const std::string& M = "123") const {
    Simulate(Path(name + "_data"),
             {"--profiles=40", "--points=20", "--seed=" + std::to_string(seed), "--M=" + M, "--encoder_jitter=0.002"});
    Append(Path(name + "_data") / "dataset.yaml", "influences: {scale_y: 1e-4}\n");
    fs::create_directories(Path("all"));
    const Outcome outcome =
        RunScancal({"refine", Path(name + "_data").string(), "--out=" + Path("all/" + name).string()});
    EXPECT_EQ(outcome.exit_code, 0) << ::testing::PrintToString(outcome);
    return Path("all/" + name).string();
  }
};

TEST_F(DiffTest, TwoOfOneInstrumentAgreeAndAMovedOneDiffers) {
  const std::string a = Calibrated("a", 1), b = Calibrated("b", 2), moved = Calibrated("moved", 3, "123.8");
  const Outcome same = RunScancal({"diff", a, b + "/calibration.json"});
  EXPECT_EQ(same.exit_code, 0) << ::testing::PrintToString(same);
  EXPECT_EQ(same.err, "");
  EXPECT_THAT(same.out, AllOf(HasSubstr("E_n"), HasSubstr("the two agree"), HasSubstr("counted once"),
                              HasSubstr("scale_y"), HasSubstr("points over the volume of A: moved by 0.")));
  const Outcome other = RunScancal({"diff", a, moved, "--format=json"});
  EXPECT_EQ(other.exit_code, 2) << ::testing::PrintToString(other);
  const Json json = Json::parse(other.out);
  EXPECT_TRUE(json["significant"]);
  EXPECT_EQ(json["changes"][0]["name"], "M");
  EXPECT_NEAR(json["changes"][0]["change"].get<double>(), 0.8, 3 * json["changes"][0]["u"].get<double>());
  // The command line and the time of a run take no part: the same data calibrated again are the same.
  EXPECT_EQ(RunScancal({"refine", a + "/calibration.json", "--out=" + Path("again").string()}).exit_code, 0);
  const Outcome again = RunScancal({"diff", a, Path("again").string(), "--format=json"});
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(Json::parse(again.out)["chi_squared"], 0);

  // Their history, of the folder and of files; the page.
  const Outcome history =
      RunScancal({"history", Path("all").string(), "--format=csv", "--out=" + Path("page.html").string()});
  EXPECT_EQ(history.exit_code, 2) << ::testing::PrintToString(history);
  EXPECT_EQ(Lines(history.out).size(), 7U) << history.out;
  EXPECT_THAT(ReadWhole(Path("page.html")), AllOf(HasSubstr("<svg"), HasSubstr("moved"), HasSubstr("</html>")));
  const Outcome quiet = RunScancal({"history", a, b});
  EXPECT_EQ(quiet.exit_code, 0) << ::testing::PrintToString(quiet);
  EXPECT_THAT(quiet.out, HasSubstr("no alarm: all 2 agree"));

  // An altered one is refused, by both.
  Json edited = *ReadJson(b + "/calibration.json");
  edited["parameters"][0]["value"] = 150;
  WriteWhole(b + "/calibration.json", edited.dump());
  for (const std::string command : {"diff", "history"}) {
    const Outcome refused = RunScancal({command, a, b});
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(OneSentence(refused), HasSubstr("M is 150, but its own data say 12"));
  }
  edited["status"] = "unreliable";
  edited.erase("data");
  WriteWhole(b + "/calibration.json", edited.dump());
  EXPECT_THAT(OneSentence(RunScancal({"diff", a, b})), HasSubstr("its status is unreliable"));
}

TEST_F(DiffTest, WrongInputIsRefused) {
  const auto refusal = [](const std::vector<std::string>& arguments) {
    const Outcome outcome = RunScancal(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.out, "");
    return OneSentence(outcome);
  };
  EXPECT_THAT(refusal({"diff", "one"}), HasSubstr("found 1 arguments, expected two"));
  EXPECT_THAT(refusal({"diff", "one", "two", "--format=yaml"}), HasSubstr("expected text or json"));
  EXPECT_THAT(refusal({"history", Path(".").string()}), HasSubstr("found no calibration.json"));
  EXPECT_THAT(refusal({"history", "one"}), HasSubstr("expected two or more"));
  EXPECT_THAT(refusal({"history", "one", "two", "--format=yaml"}), HasSubstr("expected text, csv or json"));
  for (const auto& [name, model] : {std::pair{"a.json", "turntable"}, {"b.json", "robot-ball"}})
    WriteWhole(Path(name),
               std::string(R"({"scancal": 1, "status": "ok", "parameters": [], "model": ")") + model + "\"}");
  EXPECT_THAT(refusal({"diff", Path("a.json").string(), Path("b.json").string()}),
              HasSubstr("of model \"robot-ball\""));
}

}  // namespace
}  // namespace scancal
