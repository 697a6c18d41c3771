#include "io/yaml.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace scancal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class YamlTest : public ::testing::Test {
 protected:
  YamlMap Open(std::string_view contents) {
    auto yaml = YamlMap::Parse(contents, kName);
    EXPECT_TRUE(yaml.ok()) << yaml.error().message;
    return yaml.ok() ? *yaml : YamlMap();
  }
  std::string OpenError(std::string_view contents) {
    auto yaml = YamlMap::Parse(contents, kName);
    return yaml.ok() ? "" : yaml.error().message;
  }
  static std::string FinishError(const YamlMap& yaml) {
    const auto result = yaml.Finish();
    return result.ok() ? "" : result.error().message;
  }
  static std::string Place(const std::string& place) { return kName + place; }

  inline static const std::string kName = "a folder/data set's.yaml";
};

TEST_F(YamlTest, ReadsEveryKindOfField) {
  YamlMap yaml = Open(
      "name: a plate\nstep: 1.5e0\nsearch: {M: [110, 130]}\ncolumns: [angle, y]\n"
      "targets:\n  - {name: left}\n  - name: right\n");
  EXPECT_EQ(yaml.Text("name"), "a plate");
  EXPECT_EQ(yaml.Text("absent", "otherwise"), "otherwise");
  EXPECT_EQ(yaml.Number("step"), 1.5);
  EXPECT_EQ(yaml.Number("absent", 7), 7);
  EXPECT_THAT(yaml.Map("search").Interval("M"), ElementsAre(110, 130));
  EXPECT_THAT(yaml.Texts("columns"), ElementsAre("angle", "y"));
  std::vector<YamlMap> targets = yaml.Maps("targets");
  ASSERT_EQ(targets.size(), 2U);
  EXPECT_EQ(targets[0].Text("name"), "left");
  EXPECT_EQ(targets[1].Text("name"), "right");
  EXPECT_THAT(FinishError(yaml), IsEmpty());
}

TEST_F(YamlTest, TellsWhatIsThereWithoutTakingIt) {
  const YamlMap yaml = Open("b: 1\na: {c: x}\n");
  EXPECT_THAT(yaml.Keys(), ElementsAre("b", "a"));
  EXPECT_TRUE(yaml.Has("a"));
  EXPECT_FALSE(yaml.Has("c"));
  EXPECT_TRUE(yaml.IsMap("a"));
  EXPECT_FALSE(yaml.IsMap("b"));
  EXPECT_TRUE(yaml.IsNumber("b"));
  EXPECT_FALSE(yaml.IsNumber("a"));
  EXPECT_THAT(FinishError(yaml), HasSubstr("unknown key 'b'"));
}

TEST_F(YamlTest, ByteOrderMarkAndCrLfAreFine) {
  YamlMap yaml = Open("\xEF\xBB\xBFname: plate\r\nunits:\r\n  length: mm\r\n");
  EXPECT_EQ(yaml.Text("name"), "plate");
  EXPECT_EQ(yaml.Map("units").Text("length"), "mm");
  EXPECT_THAT(FinishError(yaml), IsEmpty());
}

TEST_F(YamlTest, JsonKeepsWhatANumberWouldLose) {
  YamlMap yaml = Open(
      "certificate: {serial: 007, date: 2024-01-17, u: 0.25, n: -3, quoted: '5', version: 1.10, ok: true, none: ~, "
      "list: [1, a]}\n");
  EXPECT_EQ(yaml.Json("certificate").dump(),
            R"({"date":"2024-01-17","list":[1,"a"],"n":-3,"none":null,"ok":true,"quoted":"5","serial":"007","u":0.25,)"
            R"("version":"1.10"})");
  EXPECT_TRUE(yaml.Json("absent").is_null());
  EXPECT_THAT(FinishError(yaml), IsEmpty());
}

TEST_F(YamlTest, AnUnknownKeyIsAnErrorWithTheNearest) {
  YamlMap yaml = Open("scancal: 1\nserach: {}\n");
  yaml.Number("scancal");
  yaml.Has("search");
  EXPECT_EQ(FinishError(yaml), Place(":2:1: unknown key 'serach', did you mean 'search'?"));
}

TEST_F(YamlTest, AnUnknownKeyLikeNoOtherListsThemAll) {
  YamlMap yaml = Open("search: {M: [1, 2], nonsense: 3}\n");
  YamlMap search = yaml.Map("search");
  search.Interval("M");
  search.Has("step");
  EXPECT_EQ(FinishError(yaml), Place(":1:21: search: unknown key 'nonsense'; expected one of: M, step"));
}

TEST_F(YamlTest, UnknownKeysInListsAreFound) {
  YamlMap yaml = Open("targets:\n  - {name: a}\n  - {name: b, scam: c}\n");
  for (YamlMap& target : yaml.Maps("targets")) {
    target.Text("name");
    target.Text("scan", "");
  }
  EXPECT_EQ(FinishError(yaml), Place(":3:15: targets: item 2: unknown key 'scam', did you mean 'scan'?"));
}

TEST_F(YamlTest, AMissingKeyIsAnErrorWithTheNearest) {
  YamlMap yaml = Open("search:\n  stp: 1\n");
  EXPECT_EQ(yaml.Map("search").Number("step"), 0);
  EXPECT_EQ(FinishError(yaml),
            Place(":2:3: search: the key 'step' is missing, expected a number; did you mean 'stp'?"));
}

TEST_F(YamlTest, TheFirstErrorIsKept) {
  YamlMap yaml = Open("a: x\nb: y\n");
  yaml.Number("b");
  yaml.Number("a");
  EXPECT_EQ(FinishError(yaml), Place(":2:4: b: found \"y\", expected a number"));
  EXPECT_FALSE(yaml.Check().ok());
}

TEST_F(YamlTest, WrongKindsAreErrorsAndHarmless) {
  const std::string contents = "text: x\nlist: [1, [2], 3]\nmap: {a: 1}\nnone:\nsearch: {step: x}\n";
  const auto error = [&](auto read) {
    YamlMap yaml = Open(contents);
    read(yaml);
    return FinishError(yaml);
  };
  EXPECT_EQ(error([](YamlMap& y) { y.Text("list"); }), Place(":2:7: list: found a list, expected text"));
  EXPECT_EQ(error([](YamlMap& y) { y.Text("none"); }), Place(":4:1: none: found nothing, expected text"));
  EXPECT_EQ(error([](YamlMap& y) { y.Number("map"); }), Place(":3:6: map: found a mapping, expected a number"));
  EXPECT_EQ(error([](YamlMap& y) { y.Map("search").Number("step"); }),
            Place(":5:16: search: step: found \"x\", expected a number"));
  EXPECT_EQ(error([](YamlMap& y) { y.Texts("text"); }), Place(":1:7: text: found \"x\", expected a list of texts"));
  EXPECT_EQ(error([](YamlMap& y) { y.Texts("list"); }), Place(":2:11: list: item 2: found a list, expected text"));
  EXPECT_EQ(error([](YamlMap& y) { y.Map("text").Map("deeper").Text("still"); }),
            Place(":1:7: text: found \"x\", expected a mapping"));
  EXPECT_EQ(error([](YamlMap& y) { y.Maps("map"); }), Place(":3:6: map: found a mapping, expected a list of mappings"));
  EXPECT_EQ(error([](YamlMap& y) { y.Maps("list")[0].Text("a"); }),
            Place(":2:8: list: item 1: found \"1\", expected a mapping"));
}

TEST_F(YamlTest, NumbersAreFinite) {
  for (const std::string text : {".inf", "inf", "nan", "1e999"}) {
    YamlMap yaml = Open("a: " + text + "\n");
    EXPECT_EQ(yaml.Number("a"), 0);
    EXPECT_THAT(FinishError(yaml), HasSubstr(":1:4: a: found \"" + text + "\", expected a "));
    EXPECT_FALSE(yaml.IsNumber("a"));
  }
}

TEST_F(YamlTest, IntervalsAreTwoNumbersInOrder) {
  const auto error = [&](const std::string& interval) {
    YamlMap yaml = Open("a: " + interval + "\n");
    yaml.Interval("a");
    return FinishError(yaml);
  };
  EXPECT_EQ(error("[1, 1]"), Place(":1:4: a: found [1, 1], expected the lower bound first and a larger upper bound"));
  EXPECT_EQ(error("[1, 2, 3]"), Place(":1:4: a: found a list of 3, expected an interval [lower, upper]"));
  EXPECT_EQ(error("5"), Place(":1:4: a: found \"5\", expected an interval [lower, upper]"));
  EXPECT_EQ(error("[1, x]"), Place(":1:8: a: item 2: found \"x\", expected a number"));
  EXPECT_EQ(error("[nan, 1]"), Place(":1:5: a: item 1: found \"nan\", expected a finite number"));
}

TEST_F(YamlTest, TheCallersComplaintsHaveAPlace) {
  YamlMap yaml = Open("a: {b: 5}\n");
  YamlMap a = yaml.Map("a");
  EXPECT_EQ(a.Where("b"), Place(":1:8: a: b"));
  EXPECT_EQ(a.Where(""), Place(":1:4: a"));
  EXPECT_EQ(a.Where("c"), Place(":1:4: a: c"));
  EXPECT_EQ(yaml.Where(""), Place(":1:1"));
  a.Fail("b", "expected less than 4");
  EXPECT_EQ(FinishError(yaml), Place(":1:8: a: b: found \"5\", expected less than 4"));
}

TEST_F(YamlTest, CopiesShareErrorsAndTakenKeys) {
  YamlMap yaml = Open("a: 1\nb: {c: 2}\n");
  YamlMap copy = yaml;
  copy.Number("a");
  copy.Map("b").Number("c");
  yaml.Map("b");
  EXPECT_THAT(FinishError(yaml), IsEmpty());
  copy.Fail("", "nothing is right");
  EXPECT_EQ(FinishError(yaml), Place(":1:1: nothing is right"));
}

TEST_F(YamlTest, AMapOfNoFileIsHarmless) {
  YamlMap yaml;
  EXPECT_FALSE(yaml.Has("a"));
  EXPECT_THAT(yaml.Keys(), IsEmpty());
  EXPECT_TRUE(yaml.Finish().ok());
}

TEST_F(YamlTest, DuplicateKeysAreErrorsAtAnyDepth) {
  EXPECT_EQ(OpenError("a: 1\nb: 2\na: 3\n"), Place(":3:1: the key 'a' stands here a second time, first in line 1"));
  EXPECT_THAT(OpenError("t:\n  - {a: 1, a: 1}\n"), HasSubstr(":2:12: the key 'a' stands here a second time"));
}

TEST_F(YamlTest, SyntaxErrorsHaveAPlace) {
  EXPECT_THAT(OpenError("a: [1, 2\nb: 3\n"), HasSubstr("data set's.yaml:2:2: not YAML: "));
  EXPECT_THAT(OpenError("a: 1\n b: 2\n"), HasSubstr("data set's.yaml:2:"));
}

TEST_F(YamlTest, WhatNeedsAnotherReaderIsAnError) {
  EXPECT_THAT(OpenError("a: &x 1\nb: *x\n"), HasSubstr(":2:4: found an alias, expected the value itself"));
  EXPECT_EQ(OpenError("a: &x [1, *x]\n"), Place(":1:11: found an alias, expected the value itself"));
  EXPECT_THAT(OpenError("a: 1\n---\nb: 2\n"), HasSubstr(": found a second document, expected one"));
  EXPECT_THAT(OpenError("[a, b]: 1\n"), HasSubstr(":1:1: found a list, expected a key"));
  EXPECT_THAT(OpenError("~: 1\n"), HasSubstr(":1:1: found nothing, expected a key"));
}

TEST_F(YamlTest, TheFirstOfSeveralMistakesIsTold) {
  EXPECT_EQ(OpenError("a: 1\na: 2\nb: [\n"), Place(":2:1: the key 'a' stands here a second time, first in line 1"));
  EXPECT_EQ(OpenError("{a: 1}: 2\nb: *x\n"), Place(":1:1: found a mapping, expected a key"));
}

TEST_F(YamlTest, ANullHasThePlaceOfItsKeyOrItsOwn) {
  YamlMap yaml = Open("a:\n  b:\n  c: 1\nd:\n  - ~\n  - x\n");
  EXPECT_EQ(yaml.Map("a").Where("b"), Place(":2:3: a: b"));
  yaml.Texts("d");
  EXPECT_EQ(FinishError(yaml), Place(":5:5: d: item 1: found nothing, expected text"));
}

TEST_F(YamlTest, DeepNestingIsAnErrorAndNoCrash) {
  EXPECT_NE(OpenError(std::string(100'000, '[')), "");
  std::string maps;
  for (int i = 0; i < 100'000; ++i) maps += "{a: ";
  EXPECT_NE(OpenError(maps), "");
  maps.clear();
  for (size_t i = 0; i < 1000; ++i) maps += std::string(i, ' ') + "a:\n";
  EXPECT_NE(OpenError(maps), "");
}

// Ten of ten of ten ...: refused at the first one, before a tree of them is made.
TEST_F(YamlTest, AliasesOfAliasesTakeNoTime) {
  std::string text = "a0: &a0 [x]\n";
  for (int i = 1; i < 40; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before;
    for (int k = 0; k < 9; ++k) text += ", " + before;
    text += "]\n";
  }
  EXPECT_EQ(OpenError(text), Place(":2:10: found an alias, expected the value itself"));
}

TEST_F(YamlTest, OtherEncodingsAreErrors) {
  EXPECT_EQ(OpenError("a: 1\nname: Gl\xE4ser\n"),
            Place(":2:9: found a byte that is not UTF-8; save the file as UTF-8 text"));
}

TEST_F(YamlTest, EmptyFilesAndListsAreErrors) {
  EXPECT_EQ(OpenError(""), Place(": the file is empty, expected \"key: value\" lines"));
  EXPECT_EQ(OpenError("# only a comment\n"), Place(": the file is empty, expected \"key: value\" lines"));
  EXPECT_EQ(OpenError("- a\n- b\n"), Place(":1:1: found a list, expected \"key: value\" lines"));
  EXPECT_EQ(OpenError("text\n"), Place(":1:1: found other text, expected \"key: value\" lines"));
}

}  // namespace
}  // namespace scancal
