// scancal report, and --report of the commands that calibrate. What stands on the page: tests/report/page.
#include <gmock/gmock.h>
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

class ReportTest : public CliTest {
 protected:
  // What scancal report says of a file with these contents; nothing is written.
  void ExpectRefused(const std::string& contents, const ::testing::Matcher<std::string>& sentence) const {
    const fs::path file = Path("some.json"), page = Path("page.html");
    WriteWhole(file, contents);
    WriteWhole(page, "the old page");
    const Outcome outcome = RunScancal({"report", file.string(), "--out=" + page.string()});
    EXPECT_EQ(outcome.exit_code, 1) << ::testing::PrintToString(outcome);
    EXPECT_THAT(OneSentence(outcome), sentence);
    EXPECT_EQ(ReadWhole(page), "the old page");
  }
};

TEST_F(ReportTest, WritesPageAndPrintInEitherLanguage) {
  const fs::path folder = Path("it's \"a\" folder, ä");
  const Outcome refined = RunScancal({"refine", MakeData().string(), "--out=" + folder.string(), "--report"});
  EXPECT_EQ(refined.exit_code, 0) << ::testing::PrintToString(refined);
  EXPECT_EQ(refined.err, "");
  const std::string english = ReadWhole(folder / "report.html");
  EXPECT_THAT(english, AllOf(StartsWith("<!DOCTYPE html>"), HasSubstr("lang=\"en\"")));
  const Outcome beside = RunScancal({"report", folder.string()});  // the same page, from the file alone
  EXPECT_EQ(beside.exit_code, 0) << ::testing::PrintToString(beside);
  EXPECT_EQ(beside.out, (folder / "report.html").string() + "\n");
  EXPECT_EQ(ReadWhole(folder / "report.html"), english);
  const Outcome german = RunScancal({"report", (folder / "calibration.json").string(), "--language=de",
                                     "--out=" + Path("de.html").string(), "--pdf=" + Path("de.pdf").string()});
  EXPECT_EQ(german.exit_code, 0) << ::testing::PrintToString(german);
  EXPECT_THAT(ReadWhole(Path("de.html")), HasSubstr("lang=\"de\""));
  EXPECT_THAT(ReadWhole(Path("de.pdf")), StartsWith("%PDF-"));
}

TEST_F(ReportTest, ADoubtfulResultKeepsItsExitCode) {
  const fs::path data = MakeData();
  Replace(data / "dataset.yaml", "M: [110, 130]", "M: [125, 130]");
  const Outcome outcome = Refine(data, {"--report"});
  EXPECT_EQ(outcome.exit_code, 2) << ::testing::PrintToString(outcome);
  EXPECT_THAT(ReadWhole(Path("out") / "report.html"), HasSubstr("class=\"verdict unreliable\""));
}

TEST_F(ReportTest, RefusesWhatIsNoCalibration) {
  ExpectRefused("", HasSubstr("some.json: the file is empty"));
  ExpectRefused("{\"scancal\": 1, \"model\": \"turn", HasSubstr("some.json:1:"));
  ExpectRefused("[1, 2]", HasSubstr("is it a calibration.json?"));
  ExpectRefused("{\"scancal\": 2}", HasSubstr("format version 1, found 2"));
  ExpectRefused("\xff\xfe", HasSubstr("some.json"));
}

TEST_F(ReportTest, RefusesWrongArguments) {
  EXPECT_THAT(OneSentence(RunScancal({"report"})), HasSubstr("expected one"));
  EXPECT_THAT(OneSentence(RunScancal({"report", Path("none.json").string()})), HasSubstr("none.json"));
  EXPECT_THAT(OneSentence(RunScancal({"report", Path("none.json").string(), "--language=fr"})),
              AllOf(HasSubstr("\"fr\""), HasSubstr("en or de")));
  EXPECT_THAT(OneSentence(Refine(MakeData(), {"--report", "--language=fr"})), HasSubstr("\"fr\""));
}

TEST_F(ReportTest, TheNumbersOfTheFigures) {
  Refined(MakeData());
  const fs::path calibration = Path("out") / "calibration.json", file = Path("numbers.json");
  const std::string before = ReadWhole(calibration);
  const Outcome itself = RunScancal({"report", calibration.string(), "--figures=" + calibration.string()});
  EXPECT_EQ(itself.exit_code, 1);
  EXPECT_THAT(OneSentence(itself), HasSubstr("is the calibration itself"));
  EXPECT_EQ(ReadWhole(calibration), before);

  const Outcome outcome = RunScancal({"report", calibration.string(), "--figures=" + file.string()});
  EXPECT_EQ(outcome.exit_code, 0) << ::testing::PrintToString(outcome);
  EXPECT_EQ(outcome.out, file.string() + "\n");
  EXPECT_FALSE(fs::exists(Path("out") / "report.html"));
  Json older = *ReadJson(calibration);  // older versions kept them in the file
  const Json numbers = *ReadJson(file);
  for (const auto& [key, value] : numbers.items()) older[key] = value;
  const fs::path old = Path("older") / "calibration.json", again = Path("again.json");
  ASSERT_TRUE(WriteJson(old, older).ok());
  EXPECT_EQ(RunScancal({"report", old.string(), "--figures=" + again.string()}).exit_code, 0);
  EXPECT_EQ(ReadWhole(again), ReadWhole(file));
  const fs::path page = Path("page.html"), older_page = Path("older.html");
  EXPECT_EQ(RunScancal({"report", calibration.string(), "--out=" + page.string()}).exit_code, 0);
  EXPECT_EQ(RunScancal({"report", old.string(), "--out=" + older_page.string()}).exit_code, 0);
  EXPECT_THAT(ReadWhole(older_page), HasSubstr("id=\"surface\""));
  EXPECT_EQ(ReadWhole(page).size(), ReadWhole(older_page).size());  // but for the file's own hash
}

TEST_F(ReportTest, AResultThatItsOwnDataDoNotSayIsRefused) {
  Json result = Refined(MakeData());
  const auto expect_refused = [&](const ::testing::Matcher<std::string>& sentence) {
    ExpectRefused(result.dump(), AllOf(HasSubstr("its own data say"), sentence));
  };
  const Json sound = result;
  result["parameters"][0]["value"] = 150;
  expect_refused(HasSubstr("M is 150"));
  result = sound;
  result["parameters"][1]["u"] = result["parameters"][1]["u"].get<double>() / 2;
  expect_refused(HasSubstr("u of N is"));
  result = sound;
  result["status"] = "unreliable";
  expect_refused(HasSubstr("status is unreliable"));
}

TEST_F(ReportTest, EachFileHasANameOfItsOwn) {
  Refined(MakeData());
  const std::string same = Path("same").string();
  const Outcome outcome = RunScancal({"report", Path("out").string(), "--out=" + same, "--figures=" + same});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(OneSentence(outcome), HasSubstr("a name of its own"));
  EXPECT_FALSE(fs::exists(Path("same")));
}

TEST_F(ReportTest, AFullDiskLeavesTheOldPage) {
  Refined(MakeData());
  const fs::path page = Path("page.html");
  WriteWhole(page, "the old page");
  const Outcome outcome = RunScancal({"report", (Path("out") / "calibration.json").string(), "--out=" + page.string()},
                                     {.folder = {}, .largest_file = 20'000});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(OneSentence(outcome), HasSubstr("page.html"));
  EXPECT_EQ(ReadWhole(page), "the old page");
  std::vector<std::string> left;
  for (const auto& entry : fs::directory_iterator(page.parent_path())) left.push_back(entry.path().filename());
  EXPECT_THAT(left, UnorderedElementsAre("data", "out", "page.html"));
}

}  // namespace
}  // namespace scancal
