// scancal refine --batch: many data sets, what is done stays done, and nothing stops the others.
#include <gmock/gmock.h>
#include <chrono>
#include <thread>
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class BatchTest : public CliTest {
 protected:
  void List(const std::vector<std::string>& lines) const {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    WriteWhole(Path("list.txt"), text);
  }
  std::vector<std::string> Arguments(const std::vector<std::string>& flags) const {
    std::vector<std::string> all = {"refine", "--batch=list.txt", "--out=done"};
    all.insert(all.end(), flags.begin(), flags.end());
    return all;
  }
  Outcome Batch(const std::vector<std::string>& flags = {}) const {
    return RunScancal(Arguments(flags), {.folder = folder_.path()});
  }
  Json DataSets() const {
    const auto json = ReadJson(Path("done") / "summary.json");
    return json.ok() ? (*json)["datasets"] : Json::array();
  }
  std::vector<std::string> Values(const std::string& key) const {
    std::vector<std::string> values;
    for (const Json& each : DataSets())
      values.push_back(each[key].is_string() ? each[key].get<std::string>() : each[key].dump());
    return values;
  }
  static std::vector<pid_t> Children(pid_t parent) {
    const std::string id = std::to_string(parent);
    std::istringstream text(ReadWhole("/proc/" + id + "/task/" + id + "/children"));
    std::vector<pid_t> children;
    for (pid_t child; text >> child;) children.push_back(child);
    return children;
  }
  // What the program, the only child of this test, has started.
  static std::vector<pid_t> Started() {
    const std::vector<pid_t> own = Children(::getpid());
    return own.size() == 1 ? Children(own[0]) : own;
  }
};

TEST_F(BatchTest, OneThatFailsStopsNoOther) {
  MakeData("a");
  fs::create_directory(Path("b"));
  MakeData("c, the \"third\"");
  List({"# our scanners", "", "a\r", "b/", "  ./c, the \"third\"  "});
  const Outcome outcome = Batch({"--threads=2"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(Values("status"), ElementsAre("ok", "failed", "ok"));
  EXPECT_THAT(Values("reason")[1], HasSubstr("b/dataset.yaml"));
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("[1/3] "), HasSubstr("[3/3] "), HasSubstr("3 data sets, 1 failed, 2 ok;")));

  const std::vector<std::string> csv = Lines(ReadWhole(Path("done") / "summary.csv"));
  ASSERT_EQ(csv.size(), 4U);
  EXPECT_EQ(csv[0], "dataset,out,status,unchanged,seconds,reason,M_mm,u_M_mm,N_mm,u_N_mm");
  EXPECT_TRUE(csv[3].starts_with("\"./c, the \"\"third\"\"\",\"done/c, the \"\"third\"\"\",ok,0,"));

  // The same digits as one by one, which the summary repeats.
  Json alone = Refined(Path("a")), of_batch = *ReadJson(Path("done") / "a" / "calibration.json");
  EXPECT_EQ(alone["parameters"], of_batch["parameters"]);
  EXPECT_EQ(alone["data"], of_batch["data"]);
  EXPECT_EQ(DataSets()[0]["parameters"][0]["u"], UOf(alone, "M"));
  EXPECT_THAT(csv[1], HasSubstr("," + ParameterOf(alone, "M")["value"].dump() + ","));
  EXPECT_THAT(ReadWhole(Path("done") / "a" / "refine.txt"), HasSubstr("status: ok"));
}

TEST_F(BatchTest, WhatIsDoneAndUnchangedIsSkipped) {
  MakeData("a");
  MakeData("b");
  List({"a", "b"});
  EXPECT_EQ(Batch().exit_code, 0);
  const std::string first = ReadWhole(Path("done") / "b" / "calibration.json");
  EXPECT_EQ(Batch({"--threads=1"}).exit_code, 0);
  EXPECT_THAT(Values("unchanged"), ElementsAre("true", "true"));
  EXPECT_THAT(Values("status"), ElementsAre("ok", "ok"));

  SetLine(Path("a") / "right.csv", 2, "0,nan,0");
  EXPECT_EQ(Batch().exit_code, 0);
  EXPECT_THAT(Values("unchanged"), ElementsAre("false", "true"));
  EXPECT_EQ(ReadWhole(Path("done") / "b" / "calibration.json"), first);

  Replace(Path("done") / "b" / "calibration.json", "\"status\": \"ok\"",
          "\"status\": \"OK\"");  // not as it was written
  EXPECT_EQ(Batch().exit_code, 0);
  EXPECT_THAT(Values("unchanged"), ElementsAre("true", "false"));

  Replace(Path("done") / "b" / "done.json", "\"name\": \"M\"", "\"name\": 7");
  EXPECT_EQ(Batch().exit_code, 1);
  EXPECT_THAT(Values("reason")[1], HasSubstr("done.json was edited: remove it"));

  EXPECT_EQ(Batch({"--weights=equal"}).exit_code, 0);
  EXPECT_THAT(Values("unchanged"), ElementsAre("false", "false"));
}

TEST_F(BatchTest, UnreliableIsComputed) {
  const fs::path data = MakeData();
  Replace(data / "dataset.yaml", "M: [110, 130]", "M: [125, 130]");
  List({"data"});
  const Outcome outcome = Batch();
  EXPECT_EQ(outcome.exit_code, 0) << ::testing::PrintToString(outcome);
  EXPECT_THAT(Values("status"), ElementsAre("unreliable"));
  EXPECT_EQ(Refine(data).exit_code, 2);
  EXPECT_EQ(Refine(data, {"--accept-unreliable"}).exit_code, 0);
  EXPECT_EQ(Refine(data, {"--resume"}).exit_code, 2);
  const Outcome again = Refine(data, {"--resume"});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.out, AllOf(HasSubstr("unchanged: "), HasSubstr("status unreliable")));
}

TEST_F(BatchTest, ACrashStopsNoOther) {
  MakeData("a");
  MakeData("b");
  List({"a", "b"});
  RunningProgram program(Arguments({"--montecarlo=10000000", "--threads=1"}), {.folder = folder_.path()});
  std::vector<pid_t> killed;
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (killed.size() < 2 && !program.HasEnded() && std::chrono::steady_clock::now() < give_up) {
    for (const pid_t child : Started())
      if (killed.empty() || killed.back() != child) {
        ::kill(child, SIGKILL);
        killed.push_back(child);
      }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const Outcome outcome = program.Wait();
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(Values("status"), ElementsAre("failed", "failed"));
  EXPECT_THAT(Values("reason")[1], HasSubstr("ended by signal 9 (Killed)"));
}

TEST_F(BatchTest, CtrlCLeavesWhatIsDone) {
  std::vector<std::string> names = {"a", "b", "c"};
  for (const std::string& name : names) MakeData(name);
  List(names);
  for (const int signal : {SIGINT, SIGTERM}) {
    RunningProgram program(Arguments({"--montecarlo=10000000", "--threads=2"}), {.folder = folder_.path()});
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (Started().size() < 2 && !program.HasEnded() && std::chrono::steady_clock::now() < give_up)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    program.Signal(signal);
    const Outcome outcome = program.Wait();
    EXPECT_EQ(outcome.signal, signal) << ::testing::PrintToString(outcome);
    EXPECT_THAT(OneSentence(outcome), HasSubstr("the same command goes on"));
    EXPECT_THAT(Values("status"), ElementsAre("interrupted", "interrupted", "not started"));
    for (const auto& entry : fs::recursive_directory_iterator(Path("done")))
      EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
    fs::remove_all(Path("done"));
  }
}

TEST_F(BatchTest, AListMayComeThroughAPipe) {
  MakeData("a");
  List({Path("a").string()});
  const Outcome outcome = RunScancal({"refine", "--batch", "-", "--out", "done"},
                                     {.folder = folder_.path(), .largest_file = {}, .input = Path("list.txt")});
  EXPECT_EQ(outcome.exit_code, 0) << ::testing::PrintToString(outcome);
  EXPECT_THAT(Values("out"), ElementsAre("done" + Path("a").string()));
}

TEST_F(BatchTest, WhatIsWrongWithAListIsSaid) {
  List({"a", "# b"});
  const auto said = [&](const std::vector<std::string>& arguments) {
    const Outcome outcome = RunScancal(arguments, {.folder = folder_.path()});
    EXPECT_EQ(outcome.exit_code, 1);
    return OneSentence(outcome);
  };
  EXPECT_THAT(said({"refine", "--batch=list.txt"}), HasSubstr("--batch: found no --out"));
  EXPECT_THAT(said(Arguments({"a"})), HasSubstr("--batch: found \"a\" besides"));
  EXPECT_THAT(said(Arguments({"--threads=-1"})), HasSubstr("--threads: found -1"));
  EXPECT_THAT(said(Arguments({"--language=fr"})), HasSubstr("--language: found \"fr\""));
  EXPECT_THAT(said({"refine", "a", "--threads=2"}), HasSubstr("--threads: expected beside"));
  List({"a", "", "./a/"});
  EXPECT_THAT(said(Arguments({})), AllOf(HasSubstr("list.txt:3: \"./a/\""), HasSubstr("done/a, as that of line 1")));
  List({"../a"});
  EXPECT_THAT(said(Arguments({})), HasSubstr("list.txt:1: \"../a\": found .. in it"));
  List({"# none"});
  EXPECT_THAT(said(Arguments({})), HasSubstr("list.txt: found no data set"));
  fs::remove(Path("list.txt"));
  EXPECT_THAT(said(Arguments({})), HasSubstr("list.txt"));
  EXPECT_FALSE(fs::exists(Path("done")));
}

}  // namespace
}  // namespace scancal
