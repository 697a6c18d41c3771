#include "io/json_file.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <limits>
#include "tests/io/temporary_folder.h"

namespace scancal {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class JsonFileTest : public ::testing::Test {
 protected:
  std::string ReadError(std::string_view contents) {
    const auto json = ReadJson(folder_.Write("old result.json", contents));
    return json.ok() ? "" : json.error().message;
  }
  std::string WriteError(const Json& json) {
    const auto result = WriteJson(folder_.path() / "result.json", json);
    return result.ok() ? "" : result.error().message;
  }
  std::string Place(const std::string& place) { return (folder_.path() / "old result.json").string() + place; }

  TemporaryFolder folder_;
};

TEST_F(JsonFileTest, WritesKeysInTheirOrderAndReadsThemBack) {
  const Json json = Json::parse(
      R"({"scancal": 1, "model": "tür", "a": [0.1, 1e-300], "b": {}, "c": [{"rows": [[1, null], []], "\"": true}]})");
  ASSERT_THAT(WriteError(json), IsEmpty());
  EXPECT_EQ(folder_.Read("result.json"), R"({
  "scancal": 1,
  "model": "tür",
  "a": [0.1,1e-300],
  "b": {},
  "c": [
    {
      "rows": [
        [1,null],
        []
      ],
      "\"": true
    }
  ]
}
)");
  const auto read = ReadJson(folder_.path() / "result.json");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(*read, json);
}

TEST_F(JsonFileTest, DoublesSurviveBitForBit) {
  const double value = 0.1 + 0.2;
  ASSERT_THAT(WriteError({{"x", value}}), IsEmpty());
  EXPECT_EQ((*ReadJson(folder_.path() / "result.json"))["x"].get<double>(), value);
}

TEST_F(JsonFileTest, NanAndInfAreRefusedByTheirKey) {
  Json json;
  json["parameters"] = {{{"u", 1}}, {{"u", std::nan("")}}};
  EXPECT_EQ(WriteError(json), (folder_.path() / "result.json").string() +
                                  ": not written: parameters[1].u is nan, which JSON cannot hold");
  EXPECT_THAT(WriteError({{"a", {{"b", -std::numeric_limits<double>::infinity()}}}}), HasSubstr("a.b is -inf"));
  EXPECT_THAT(folder_.Names(), IsEmpty());
}

TEST_F(JsonFileTest, TextThatIsNotUtf8IsRefusedByItsKey) {
  EXPECT_THAT(WriteError({{"inputs", {{{"file", "Gl\xE4ser"}}}}}), HasSubstr("inputs[0].file is not UTF-8 text"));
  EXPECT_THAT(WriteError({{"a", {{"\xE4", 1}}}}), HasSubstr("a has a key that is not UTF-8"));
}

TEST_F(JsonFileTest, SyntaxErrorsHaveAPlace) {
  EXPECT_THAT(ReadError("{\n  \"a\": 1,\n  b: 2}\n"), HasSubstr(Place(":3:3: not JSON: invalid literal")));
  EXPECT_THAT(ReadError("{\"a\": [1, 2"), HasSubstr(Place(":1:12: not JSON: unexpected end of input")));
  EXPECT_THAT(ReadError("{\"a\": 1e999}"), HasSubstr(": not JSON: "));
  EXPECT_THAT(ReadError("{} {}"), HasSubstr(Place(":1:4: not JSON: ")));
}

TEST_F(JsonFileTest, AByteOrderMarkIsFine) { EXPECT_THAT(ReadError("\xEF\xBB\xBF{}"), IsEmpty()); }

TEST_F(JsonFileTest, EmptyMissingAndFolderAreErrors) {
  EXPECT_EQ(ReadError(" \n"), Place(": the file is empty, expected JSON"));
  EXPECT_THAT(ReadJson(folder_.path() / "none.json").error().message, EndsWith("none.json: no such file"));
  EXPECT_THAT(ReadJson(folder_.path()).error().message, EndsWith(": found a folder, expected a file"));
}

TEST(Base64Test, KnownAnswers) {  // RFC 4648, section 10
  for (const auto& [bytes, text] : {std::pair{"", ""},
                                    {"f", "Zg=="},
                                    {"fo", "Zm8="},
                                    {"foo", "Zm9v"},
                                    {"foob", "Zm9vYg=="},
                                    {"fooba", "Zm9vYmE="},
                                    {"foobar", "Zm9vYmFy"}}) {
    EXPECT_EQ(ToBase64(bytes), text);
    ASSERT_TRUE(FromBase64(text).ok());
    EXPECT_EQ(*FromBase64(text), bytes);
  }
}

TEST(Base64Test, EveryByteAndEveryLengthComesBack) {
  std::string bytes;
  for (int i = 0; i < 600; ++i) {
    ASSERT_EQ(*FromBase64(ToBase64(bytes)), bytes) << i;
    bytes += static_cast<char>(i * 7);
  }
}

TEST(Base64Test, BlocksDoNotShow) {
  const std::string bytes((size_t{3} << 20) + 1, 'x');
  const std::string text = ToBase64(bytes);
  EXPECT_EQ(text.size(), (bytes.size() + 2) / 3 * 4);
  EXPECT_EQ(text.find('='), text.size() - 2);
  EXPECT_TRUE(*FromBase64(text) == bytes);
}

TEST(Base64Test, OtherTextIsAnError) {
  for (const auto& [text, complaint] : {std::pair{"Zm9vYg=", "found 7 characters"},
                                        {"Zm9", "found 3 characters"},
                                        {" Zm9v", "found \" \" as character 1"},
                                        {"Zm9v\n", "as character 5"},
                                        {"Zm=v", "found \"=\" as character 3"},
                                        {"Z===", "found \"=\" as character 2"},
                                        {"====", "found \"=\" as character 1"},
                                        {"Zm9-", "found \"-\" as character 4"}}) {
    const auto bytes = FromBase64(text);
    ASSERT_FALSE(bytes.ok()) << text;
    EXPECT_THAT(bytes.error().message, HasSubstr(complaint)) << text;
  }
}

}  // namespace
}  // namespace scancal
