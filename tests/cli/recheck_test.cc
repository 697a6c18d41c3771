// A result is what its own data say: scancal recheck, and what the other commands refuse.
#include <gmock/gmock.h>
#include <algorithm>
#include <cmath>
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

// A pair of Ed25519, and the public key of another.
constexpr char kPrivate[] =
    "-----BEGIN PRIVATE KEY-----\nMC4CAQAwBQYDK2VwBCIEILVmq1bEeKdvpjZpf1AIdh294nL+qDaStC8zEYY+hH1L\n"
    "-----END PRIVATE KEY-----\n";
constexpr char kPublic[] =
    "-----BEGIN PUBLIC KEY-----\nMCowBQYDK2VwAyEAzu+L4lDvbKW1pv7EdYMlknSVOWFiuwGG19xq5tPLurQ=\n"
    "-----END PUBLIC KEY-----\n";
constexpr char kOther[] =
    "-----BEGIN PUBLIC KEY-----\nMCowBQYDK2VwAyEALZ8MKcs4Tv39NguSfpLzaWZsGxpO9oQUmN+H4enktfg=\n"
    "-----END PUBLIC KEY-----\n";

class RecheckTest : public CliTest {
 protected:
  Outcome Recheck(const std::vector<std::string>& flags = {}) const {
    std::vector<std::string> arguments = {"recheck", file_.string()};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    return RunScancal(arguments);
  }
  Outcome Propagate(const std::vector<std::string>& flags = {}) const {
    std::vector<std::string> arguments = {"propagate", file_.string(), "--point=0,50,0"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    return RunScancal(arguments);
  }
  Outcome Transform(const fs::path& data, const std::vector<std::string>& flags = {}) const {
    std::vector<std::string> arguments = {"transform", data.string(), "--calibration=" + file_.string(),
                                          "--out=" + Path("cloud.csv").string()};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    return RunScancal(arguments);
  }
  void Write(const Json& json) const { ASSERT_TRUE(WriteJson(file_, json).ok()); }
  std::string Refusal(const Outcome& outcome) const {
    EXPECT_EQ(outcome.exit_code, 1) << ::testing::PrintToString(outcome);
    return OneSentence(outcome);
  }
  fs::path Key(const std::string& name, const std::string& pem) const {
    WriteWhole(Path(name), pem);
    return Path(name);
  }

  const fs::path file_ = Path("out") / "calibration.json";
};

TEST_F(RecheckTest, SaysInOneLineThatItHolds) {
  const fs::path data = MakeData();
  Append(data / "dataset.yaml", "certificate: {item: {name: profiler}}\n");
  Refined(data, 0, {"--montecarlo=200"});
  const Outcome outcome = Recheck();
  EXPECT_EQ(outcome.exit_code, 0) << ::testing::PrintToString(outcome);
  EXPECT_EQ(Lines(outcome.out).size(), 1U);
  EXPECT_THAT(outcome.out,
              AllOf(StartsWith(file_.string()), HasSubstr("are what its own data say"), HasSubstr("status ok")));
  EXPECT_EQ(RunScancal({"recheck", Path("out").string()}).out, outcome.out);
  Replace(data / "dataset.yaml", "M: [110, 130]", "M: [125, 130]");
  Refined(data, 2);
  EXPECT_EQ(Recheck().exit_code, 2);
}

// Whatever the page or a certificate shows, changed by what one digit less would not tell.
TEST_F(RecheckTest, EveryNumberAndSentenceIsCovered) {
  const fs::path data = MakeData();
  Append(data / "dataset.yaml", "certificate: {item: {name: profiler}}\ninfluences: {scale_y: 1e-4}\n");
  const Json sound = Refined(data, 0, {"--montecarlo=200"});
  using Pointer = Json::json_pointer;
  for (const char* at : {"/parameters/0/value",
                         "/parameters/1/u",
                         "/parameters/0/U",
                         "/parameters/0/k",
                         "/parameters/1/dof",
                         "/parameters/0/u_jackknife",
                         "/parameters/0/u_bootstrap",
                         "/covariance/0/1",
                         "/correlation/0/1",
                         "/joint/k",
                         "/budget/0/value",
                         "/budget/0/share/M",
                         "/lack_of_fit/F",
                         "/misfits/0/size",
                         "/influences/0/u",
                         "/jackknife/1/value/N",
                         "/targets/0/rms",
                         "/targets/0/points",
                         "/targets/0/distance",
                         "/grid/M",
                         "/volume/rows/3/9",
                         "/scene/targets/0/outline/rows/0/0",
                         "/montecarlo/parameters/0/mean",
                         "/montecarlo/parameters/0/histogram/counts/40",
                         "/sigma",
                         "/condition",
                         "/iterations"}) {
    Json edited = sound;
    Json& number = edited.at(Pointer(at));
    const double u = std::string(at) == "/parameters/0/value" ? sound["parameters"][0]["u"].get<double>() : 0;
    if (number.is_number_integer()) number = number.get<int64_t>() + 1;
    else number = number.get<double>() + 3e-6 * (u > 0 ? u : std::max(1.0, std::abs(number.get<double>())));
    Write(edited);
    const Outcome outcome = Recheck();
    EXPECT_EQ(outcome.exit_code, 1) << at << " " << number;
    if (std::string(at) != "/covariance/0/1") {
      EXPECT_THAT(outcome.err, HasSubstr("its own data say")) << at;
    }
  }
  for (const char* at : {"/name", "/weights", "/parameters/0/role", "/determined/M", "/budget/0/source",
                         "/certificate/item/name", "/montecarlo/parameters/0/verdict", "/targets/1/name"}) {
    Json edited = sound;
    edited.at(Pointer(at)) = "edited";
    Write(edited);
    EXPECT_EQ(Recheck().exit_code, 1) << at;
  }
  for (const auto& [key, value] : {std::pair<const char*, Json>{"warnings", {"all is well"}},
                                   {"unreliable", {"nothing"}},
                                   {"status", "unreliable"},
                                   {"converged", false},
                                   {"remarks", 1}}) {
    Json edited = sound;
    edited[key] = value;
    Write(edited);
    EXPECT_EQ(Recheck().exit_code, 1) << key;
  }
  Json edited = sound;
  edited.erase("budget");
  Write(edited);
  EXPECT_THAT(Refusal(Recheck()), HasSubstr("budget is missing"));
  edited = sound;
  edited["data"]["dataset"] = sound["data"]["dataset"].get<std::string>() + "# by another hand\n";
  Write(edited);
  EXPECT_THAT(Refusal(Recheck()), HasSubstr("SHA-256 of dataset.yaml"));
  edited = sound;
  edited["compare"] = Json::array({{{"method", "figures of an older version"}}});  // does not keep it from the check
  edited["parameters"][0]["value"] = 150;
  Write(edited);
  EXPECT_THAT(Refusal(RunScancal({"report", file_.string()})), HasSubstr("M is 150"));
}

TEST_F(RecheckTest, WhatMeasuresChecksFirst) {
  const fs::path data = MakeData();
  Json edited = Refined(data);
  edited["parameters"][0]["value"] = 150.0;
  Write(edited);
  EXPECT_THAT(Refusal(Propagate()), HasSubstr("M is 150, but its own data say 12"));
  EXPECT_THAT(Refusal(Transform(data)), HasSubstr("M is 150, but its own data say 12"));
  EXPECT_FALSE(fs::exists(Path("cloud.csv")));
  const Json sound = Refined(data);
  Write(edited);
  fs::rename(file_, Path("edited.json"));
  Write(sound);
  EXPECT_THAT(Refusal(RunScancal({"report", file_.string(), "--previous=" + Path("edited.json").string()})),
              AllOf(HasSubstr("edited.json"), HasSubstr("M is 150")));
}

TEST_F(RecheckTest, OfAnotherVersionTheDifferenceIsSaid) {
  const fs::path data = MakeData();
  Json older = Refined(data);
  older["version"] = "0.0.9";
  older.erase("joint");  // it did not have all keys
  older["remarks"] = 1;
  Write(older);
  EXPECT_EQ(Recheck().exit_code, 0);
  EXPECT_EQ(Propagate().err, "");
  older["parameters"][0]["value"] = 150.0;
  Write(older);
  EXPECT_THAT(Refusal(Recheck()), AllOf(HasSubstr("scancal 0.0.9 wrote this file"), HasSubstr("M is 150 in the file")));
  const Outcome propagated = Propagate();
  EXPECT_EQ(propagated.exit_code, 2);
  EXPECT_THAT(OneSentence(propagated), AllOf(StartsWith("warning: "), HasSubstr("M is 150 in the file")));
  EXPECT_EQ(Transform(data).exit_code, 2);
  const fs::path page = Path("page.html"), dcc = Path("dcc.xml");
  const Outcome report = RunScancal({"report", file_.string(), "--language=de", "--out=" + page.string()});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  EXPECT_THAT(ReadWhole(page), HasSubstr("berechnet aus denselben Daten anderes"));
  EXPECT_THAT(Refusal(RunScancal({"report", file_.string(), "--dcc=" + dcc.string()})), HasSubstr("no certificate"));
  EXPECT_FALSE(fs::exists(dcc));
}

TEST_F(RecheckTest, WithoutDataNobodyCanSay) {
  const fs::path data = MakeData();
  Json bare = Refined(data);
  bare.erase("data");
  Write(bare);
  EXPECT_THAT(Refusal(Recheck()), HasSubstr("holds no compressed data"));
  EXPECT_EQ(Propagate().exit_code, 2);
  EXPECT_THAT(OneSentence(Transform(data)), HasSubstr("holds no compressed data"));
  const fs::path page = Path("page.html");
  EXPECT_EQ(RunScancal({"report", file_.string(), "--out=" + page.string()}).exit_code, 0);
  EXPECT_THAT(ReadWhole(page), HasSubstr("holds no compressed data"));
  EXPECT_THAT(Refusal(RunScancal({"report", file_.string(), "--dcc=" + Path("dcc.xml").string()})),
              HasSubstr("no certificate"));
}

TEST_F(RecheckTest, WhatIsUnreliableMeasuresOnlyIfOneInsists) {
  const fs::path data = MakeData();
  Replace(data / "dataset.yaml", "M: [110, 130]", "M: [125, 130]");
  Refined(data, 2);
  EXPECT_THAT(Refusal(Propagate()), HasSubstr("add --unreliable"));
  EXPECT_THAT(Refusal(Transform(data)), HasSubstr("add --unreliable"));
  const Outcome insisted = Propagate({"--unreliable"});
  EXPECT_EQ(insisted.exit_code, 2) << ::testing::PrintToString(insisted);
  EXPECT_THAT(insisted.err, HasSubstr("warning: "));
  EXPECT_EQ(Transform(data, {"--unreliable"}).exit_code, 2);
  EXPECT_TRUE(fs::exists(Path("cloud.csv")));
}

TEST_F(RecheckTest, DataOfAnotherInstrumentAreRefused) {
  const fs::path data = MakeData();
  const std::string item = "certificate: {item: {identifications: [{issuer: maker, value: 0815}]}}\n";
  Append(data / "dataset.yaml", item);
  Refined(data);
  EXPECT_EQ(Transform(data).exit_code, 0);
  const std::string text = ReadWhole(data / "dataset.yaml");
  const auto refused = [&](const std::string& from, const std::string& to) {
    WriteWhole(data / "dataset.yaml", text);
    Replace(data / "dataset.yaml", from, to);
    return Refusal(Transform(data));
  };
  EXPECT_THAT(refused("rotation: clockwise", "rotation: counterclockwise"),
              AllOf(HasSubstr("rotation is \"counterclockwise\""), HasSubstr("\"clockwise\"")));
  EXPECT_THAT(refused("length: mm", "length: um"), HasSubstr("units is"));
  EXPECT_THAT(refused("0815", "0816"), AllOf(HasSubstr("identification is \"0816\""), HasSubstr("\"0815\"")));
  WriteWhole(data / "dataset.yaml", text.substr(0, text.size() - item.size()));  // says nothing: no contradiction
  EXPECT_EQ(Transform(data).exit_code, 0);
}

TEST_F(RecheckTest, ASignatureIsOfTheseBytesByThisKey) {
  const fs::path key = Key("it's my key.pem", kPrivate), mine = Key("mine.pub", kPublic), other = Key("x.pub", kOther);
  Refined(MakeData(), 0, {"--sign=" + key.string()});
  EXPECT_EQ(ReadWhole(file_.string() + ".sig").size(), 64U);
  EXPECT_THAT(Recheck({"--key=" + mine.string()}).out, HasSubstr("signed by the key of"));
  EXPECT_EQ(Propagate({"--key=" + mine.string()}).exit_code, 0);
  EXPECT_THAT(Refusal(Recheck({"--key=" + other.string()})), HasSubstr("another key signed it"));
  const std::string sound = ReadWhole(file_);
  Append(file_, "\n");  // which changes no number
  EXPECT_EQ(Recheck().exit_code, 0);
  EXPECT_THAT(Refusal(Recheck({"--key=" + mine.string()})), HasSubstr("the file was changed"));
  EXPECT_THAT(Refusal(Propagate({"--key=" + mine.string()})), HasSubstr("the file was changed"));
  EXPECT_EQ(Recheck({"--sign=" + key.string()}).exit_code, 0);  // who has checked it may sign it
  EXPECT_EQ(Recheck({"--key=" + mine.string()}).exit_code, 0);
  fs::remove(file_.string() + ".sig");
  EXPECT_THAT(Refusal(Recheck({"--key=" + mine.string()})), HasSubstr("calibration.json.sig: no such file"));
  EXPECT_THAT(Refusal(Recheck({"--key=" + key.string()})), HasSubstr("expected a public key in PEM"));
  const Outcome unsigned_ = Refine(Path("data"), {"--sign=" + mine.string()});
  EXPECT_THAT(Refusal(unsigned_), HasSubstr("expected a private key in PEM"));
  EXPECT_EQ(ReadWhole(file_), sound + "\n");  // told before the work
}

}  // namespace
}  // namespace scancal
