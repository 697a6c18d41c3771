// A result holds all it was computed from: refine takes calibration.json in place of the data set.
#include <gmock/gmock.h>
#include "io/units.h"
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;

class RecomputeTest : public CliTest {
 protected:
  // Refines, deletes the data set and returns the result, kept in folder_/old.
  Json Old(const fs::path& data, int exit_code = 0, const std::vector<std::string>& flags = {}) const {
    Json old = Refined(data, exit_code, flags);
    fs::remove_all(data);
    fs::rename(Path("out"), Path("old"));
    return old;
  }
  // All but where it came from, digit by digit.
  static void ExpectSame(Json a, Json b) {
    for (const char* key : {"inputs", "command"}) {
      a.erase(key);
      b.erase(key);
    }
    EXPECT_TRUE(a == b) << Json::diff(a, b).dump(2);
  }
  std::string ErrorOfRefining(const std::string& contents) const {
    WriteWhole(old_, contents);
    const Outcome outcome = Refine(old_);
    EXPECT_EQ(outcome.exit_code, 1) << ::testing::PrintToString(outcome);
    EXPECT_FALSE(fs::exists(Path("out")));
    return OneSentence(outcome);
  }

  const fs::path old_ = Path("old") / "calibration.json";
};

TEST_F(RecomputeTest, TheSameDigitsWithoutTheScans) {
  const fs::path data = Path("data");
  Simulate(data, {"--profiles=40", "--points=20", "--outliers=0.02", "--missing=0.02", "--encoder_jitter=0.002"});
  Append(data / "dataset.yaml",
         "parameters: {tilt_x: estimate, tilt_y: {consider: 0, u: 0.03}}\ninfluences: {scale_y: 1e-4, form: 0.001}\n"
         "certificate: {laboratory: \"M\u00FCller & <b>S\u00F6hne</b>\", number: 007, items: [{id: 1.5}]}\n");
  const Json old = Old(data);
  EXPECT_EQ(old["certificate"]["number"], "007");
  EXPECT_EQ(old["certificate"]["items"][0]["id"], 1.5);
  EXPECT_TRUE(old["compare"].empty() && old["surface"].empty());  // what only the report needs
  EXPECT_EQ(old["scene"]["targets"][0]["views"]["rows"].size(), 9U);
  EXPECT_GT(old["targets"][0]["set_aside"].get<double>(), 5);
  EXPECT_GT(old["residuals"]["targets"][0]["lags"].size(), 3U);
  ExpectSame(old, Refined(old_));

  const fs::path file = Path("figures.json");
  ASSERT_EQ(RunScancal({"report", old_.string(), "--figures=" + file.string()}).exit_code, 0);
  const Json figures = *ReadJson(file);
  EXPECT_EQ(figures["compare"].size(), 8U);
  EXPECT_EQ(figures["compare"].dump().find("\"s\""), std::string::npos);  // no computing times
  EXPECT_EQ(figures["surface"]["near"]["rows"].size(), 41U * 41U);
  EXPECT_GT(figures["residuals"]["targets"][2]["cells"]["rows"].size(), 100U);
  EXPECT_EQ(figures["residuals"]["targets"][2]["histogram"], old["residuals"]["targets"][2]["histogram"]);
}

TEST_F(RecomputeTest, FiguresOfWhatWasFittedOtherwise) {
  const fs::path data = MakeData(), file = Path("figures.json");
  const auto cells = [&](const std::vector<std::string>& flags) {
    Refined(data, 0, flags);
    EXPECT_EQ(RunScancal({"report", Path("out").string(), "--figures=" + file.string()}).exit_code, 0);
    return (*ReadJson(file))["residuals"]["targets"][0]["cells"];
  };
  const Json weighted = cells({}), equal = cells({"--weights=equal"}), plane = cells({"--residual=plane"});
  EXPECT_NE(weighted, equal);
  EXPECT_NE(equal, plane);
}

TEST_F(RecomputeTest, FromWhatWasItselfRecomputed) {
  const Json old = Old(MakeData());
  const Json second = Refined(old_);
  fs::remove_all(Path("old"));
  fs::rename(Path("out"), Path("old"));
  const Json third = Refined(old_);
  ExpectSame(old, third);
  ASSERT_EQ(second["inputs"].size(), 1 + old["inputs"].size());
  EXPECT_EQ(second["inputs"][0]["file"], "calibration.json");
  EXPECT_EQ(second["inputs"][1], old["inputs"][0]);  // what it was made from
  EXPECT_EQ(third["inputs"].size(), 2 + old["inputs"].size());
}

TEST_F(RecomputeTest, InItsOwnPlace) {
  const Json old = Old(MakeData());
  const Outcome outcome = RunScancal({"refine", old_.string(), "--out=" + Path("old").string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  ExpectSame(old, *ReadJson(old_));
}

TEST_F(RecomputeTest, WithOtherFlags) {
  const fs::path data = MakeData();
  const Json plane = Refined(data, 0, {"--residual=plane"});
  Old(data);
  ExpectSame(plane, Refined(old_, 0, {"--residual=plane"}));
}

TEST_F(RecomputeTest, OfALidar) {
  const fs::path data = MakeData();
  for (const std::string& name : kNames) {
    std::vector<std::vector<double>> rows;
    for (const ScanPoint& p : ReadPoints(data / (name + ".csv")))
      rows.push_back({p.angle, std::atan2(p.z, p.y) / kDegree, std::hypot(p.y, p.z)});
    WriteTable(data / (name + ".csv"), "angle,bearing,range", rows);
  }
  const Json old = Old(data, 2);  // its noise is along depth, not along the range: a lack of fit that is found
  EXPECT_TRUE(old["data"]["targets"][0]["lidar"]);
  ExpectSame(old, Refined(old_, 2));
}

TEST_F(RecomputeTest, OfARobot) {
  const fs::path data = Path("data");
  Simulate(data, {"--model=robot-ball", "--stations=4", "--declare"});
  const Json old = Old(data);
  EXPECT_EQ(old["residuals"]["targets"][1]["poses"]["rows"].size(), 8U);
  EXPECT_EQ(old["scene"]["targets"].size(), 4U);
  ExpectSame(old, Refined(old_));
}

TEST_F(RecomputeTest, DoubtsRemain) {
  const fs::path data = MakeData();
  Replace(data / "dataset.yaml", "[110, 130]", "[100, 115]");
  const Json old = Old(data, 2);
  ExpectSame(old, Refined(old_, 2));
}

TEST_F(RecomputeTest, WarningsOfReadingRemain) {
  const fs::path data = MakeData();
  for (const std::string& name : kNames) {  // points of different profiles in turn
    const auto profiles = Profiles(ReadPoints(data / (name + ".csv")));
    std::vector<ScanPoint> points;
    for (size_t i = 0; i < profiles[0].size(); i += 5)
      for (const auto& profile : profiles) points.push_back(profile[i]);
    WritePoints(data / (name + ".csv"), points);
  }
  const Outcome outcome = Refine(data);
  ASSERT_NE(outcome.exit_code, 1) << outcome.err;
  const Json old = Old(data, outcome.exit_code);
  EXPECT_THAT(Sentences(old, "warnings"), HasSubstr("add a column profile"));
  EXPECT_THAT(old["messages"].dump(), HasSubstr("eine Spalte profile"));
  ExpectSame(old, Refined(old_, outcome.exit_code));
}

TEST_F(RecomputeTest, DeclarationsMayBeChangedInIt) {
  Json json = Old(MakeData());
  json["data"]["dataset"] = json["data"]["dataset"].get<std::string>() + "influences: {scale_y: 1e-4}\n";
  WriteWhole(old_, json.dump(2));
  EXPECT_GT(UOf(Refined(old_), "N"), UOf(json, "N"));
  json["data"]["dataset"] = json["data"]["dataset"].get<std::string>() + "serch: 1\n";
  WriteWhole(old_, json.dump(2));
  EXPECT_THAT(OneSentence(Refine(old_)),
              AllOf(HasSubstr("calibration.json: data: dataset:"), HasSubstr("unknown key 'serch'")));
}

TEST_F(RecomputeTest, DamagedDataAreRefused) {
  const Json sound = Old(MakeData());
  const auto with_segments = [&](const std::string& segments) {
    Json json = sound;
    json["data"]["segments"] = segments;
    return json.dump(2);
  };
  const std::string segments = sound["data"]["segments"];
  std::string changed = segments;
  changed[1000] = changed[1000] == 'A' ? 'B' : 'A';
  EXPECT_THAT(ErrorOfRefining(with_segments(changed)),
              AllOf(HasSubstr("SHA-256"), EndsWith("take another copy of it")));
  changed[1000] = '?';
  EXPECT_THAT(ErrorOfRefining(with_segments(changed)), HasSubstr("found \"?\" as character 1001, expected base64"));
  EXPECT_THAT(ErrorOfRefining(with_segments(segments.substr(0, 1001))), HasSubstr("found 1001 characters"));
  EXPECT_THAT(ErrorOfRefining(with_segments(segments.substr(0, 1000))), HasSubstr("SHA-256"));
  EXPECT_THAT(ErrorOfRefining(with_segments("")), HasSubstr("SHA-256"));
  const std::string whole = sound.dump(2);
  EXPECT_THAT(ErrorOfRefining(whole.substr(0, whole.size() / 2)), HasSubstr("not JSON: "));
  EXPECT_THAT(ErrorOfRefining(""), HasSubstr("the file is empty"));
  EXPECT_THAT(ErrorOfRefining(std::string(1'000'000, '[')), HasSubstr("not JSON: "));
}

TEST_F(RecomputeTest, IncompleteDataAreRefused) {
  const Json sound = Old(MakeData());
  for (const auto& [key, complaint] :
       {std::pair{"segments", "found no segments"}, {"targets", "found no list of targets"}, {"sha256", "SHA-256"}}) {
    Json json = sound;
    json["data"].erase(key);
    EXPECT_THAT(ErrorOfRefining(json.dump(2)), HasSubstr(complaint)) << key;
  }
  Json json = sound;
  json["data"]["targets"][0]["name"] = "somewhere";
  EXPECT_THAT(ErrorOfRefining(json.dump(2)), HasSubstr("expected the targets that data: dataset declares"));
}

TEST_F(RecomputeTest, ResultsOfOlderVersionsAreRefused) {
  Json json = Old(MakeData());
  for (const Json& data : {Json{{"factors", Json::array()}, {"segments", ""}}, Json(5), Json::object()}) {
    json["data"] = data;
    EXPECT_THAT(ErrorOfRefining(json.dump(2)), AllOf(HasSubstr("calibration.json: found no compressed data"),
                                                     HasSubstr("refine the data set itself")));
  }
  json.erase("data");
  EXPECT_THAT(ErrorOfRefining(json.dump(2)), HasSubstr("found no compressed data"));
  EXPECT_THAT(ErrorOfRefining("{}"), HasSubstr("is it a calibration.json?"));
}

TEST_F(RecomputeTest, CompareTakesItTransformNeedsScans) {
  const fs::path data = MakeData();
  Replace(data / "dataset.yaml", "M: [110, 130], N: [395, 425]", "M: [122, 124], N: [408, 410]");
  Old(data);
  const Outcome compared = RunScancal({"compare", old_.string()});
  EXPECT_EQ(compared.exit_code, 0) << compared.err;
  const Outcome transformed =
      RunScancal({"transform", old_.string(), "--calibration=" + old_.string(), "--out=" + Path("x.ply").string()});
  EXPECT_EQ(transformed.exit_code, 1);
  EXPECT_THAT(OneSentence(transformed), HasSubstr("found a result without scans"));
}

}  // namespace
}  // namespace scancal
