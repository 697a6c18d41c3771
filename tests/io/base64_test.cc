#include "io/base64.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scancal {
namespace {

using ::testing::HasSubstr;

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
