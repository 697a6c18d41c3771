// A full disk and Ctrl-C: the old file or the new one, never half of one.
#include <gmock/gmock.h>
#include <chrono>
#include <thread>
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class InterruptionTest : public CliTest {
 protected:
  static std::vector<std::string> NamesIn(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }
  // 1.2 million points in one scan: written in about a second.
  void MakeLargeScan() const {
    const std::string text = ReadWhole(data_ / "left.csv");
    const std::string header = text.substr(0, text.find('\n') + 1), points = text.substr(header.size());
    std::string large = header;
    for (int k = 0; k < 1500; ++k) large += points;
    WriteWhole(data_ / "left.csv", large);
  }

  const fs::path data_ = MakeData();
};

TEST_F(InterruptionTest, AFullDiskLeavesTheOldResult) {
  fs::create_directory(Path("out"));
  WriteWhole(Path("out") / "calibration.json", "old");
  const Outcome outcome =
      RunScancal({"refine", data_.string(), "--out=" + Path("out").string()}, {.folder = {}, .largest_file = 1000});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(OneSentence(outcome),
              AllOf(HasSubstr("calibration.json: cannot be written: "), HasSubstr("File too large")));
  EXPECT_EQ(ReadWhole(Path("out") / "calibration.json"), "old");
  EXPECT_THAT(NamesIn(Path("out")), ElementsAre("calibration.json"));
}

TEST_F(InterruptionTest, AFullDiskLeavesNoPointCloud) {
  EXPECT_EQ(Refine(data_).exit_code, 0);
  for (const char* name : {"cloud.ply", "cloud.csv", "cloud.npy"}) {
    const Outcome outcome =
        RunScancal({"transform", data_.string(), "--calibration=" + (Path("out") / "calibration.json").string(),
                    "--out=" + Path(name).string()},
                   {.folder = {}, .largest_file = 50000});
    EXPECT_EQ(outcome.exit_code, 1) << name;
    EXPECT_THAT(OneSentence(outcome), HasSubstr("cannot be written: File too large"));
  }
  EXPECT_THAT(NamesIn(folder_.path()), ElementsAre("data", "out"));
}

TEST_F(InterruptionTest, AFullDiskLeavesNoHalfSimulation) {
  const Outcome outcome = RunScancal({"simulate", "--profiles=40", "--points=20", "--out=" + Path("new").string()},
                                     {.folder = {}, .largest_file = 5000});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(OneSentence(outcome), HasSubstr("left.csv: cannot be written: File too large"));
  EXPECT_TRUE(NamesIn(Path("new")).empty());
}

TEST_F(InterruptionTest, CtrlCLeavesNoPointCloud) {
  EXPECT_EQ(Refine(data_).exit_code, 0);
  MakeLargeScan();
  fs::create_directory(Path("clouds"));
  for (const int signal : {SIGINT, SIGTERM}) {
    WriteWhole(Path("clouds") / "cloud.csv", "old");
    RunningProgram program({"transform", data_.string(), "--calibration=" + (Path("out") / "calibration.json").string(),
                            "--out=" + (Path("clouds") / "cloud.csv").string()});
    // Until the temporary file grows: then it is in the middle of its work.
    bool writing = false;
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!writing && !program.HasEnded() && std::chrono::steady_clock::now() < give_up) {
      std::error_code gone;
      for (const auto& entry : fs::directory_iterator(Path("clouds")))
        writing |= entry.path().extension() == ".tmp" && fs::file_size(entry.path(), gone) > 0 && !gone;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ASSERT_TRUE(writing) << "the scan is too small to be interrupted";
    program.Signal(signal);
    const Outcome outcome = program.Wait();
    EXPECT_EQ(outcome.signal, signal) << ::testing::PrintToString(outcome);  // a shell sees 128 + signal
    EXPECT_THAT(NamesIn(Path("clouds")), ElementsAre("cloud.csv"));
    EXPECT_EQ(ReadWhole(Path("clouds") / "cloud.csv"), "old");
  }
}

TEST_F(InterruptionTest, CtrlCInAMonteCarloLeavesTheOldResult) {
  fs::create_directory(Path("out"));
  for (const int signal : {SIGINT, SIGTERM}) {
    WriteWhole(Path("out") / "calibration.json", "old");
    RunningProgram program(
        {"montecarlo", data_.string(), "--trials=10000000", "--threads=2", "--out=" + Path("out").string()});
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (NamesIn(Path("out")).size() < 2 && !program.HasEnded() && std::chrono::steady_clock::now() < give_up)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));  // until it has taken its place
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    ASSERT_FALSE(program.HasEnded());
    program.Signal(signal);
    const Outcome outcome = program.Wait();
    EXPECT_EQ(outcome.signal, signal);
    EXPECT_THAT(outcome.err, HasSubstr("calibration.json was not written"));
    EXPECT_THAT(NamesIn(Path("out")), ElementsAre("calibration.json"));
    EXPECT_EQ(ReadWhole(Path("out") / "calibration.json"), "old");
  }
}

}  // namespace
}  // namespace scancal
