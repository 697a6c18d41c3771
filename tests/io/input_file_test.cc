#include "io/input_file.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include "tests/io/temporary_folder.h"

namespace scancal {
namespace {

// FIPS 180-4, examples of NIST: "", "abc" and a million times "a".
TEST(HashTest, KnownAnswers) {
  const TemporaryFolder folder;
  EXPECT_EQ(*Sha256(folder.Write("empty", "")), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(*Sha256(folder.Write("abc", "abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(*Sha256(folder.Write("million", std::string(1'000'000, 'a'))),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(HashTest, OfATextIsThatOfAFileWithIt) {
  const TemporaryFolder folder;
  for (const char* text : {"", "abc"}) EXPECT_EQ(*Sha256OfText(text), *Sha256(folder.Write("text", text)));
}

// One block of reading and one byte more or less: the same text read in another way.
TEST(HashTest, BlocksOfReadingDoNotShow) {
  const TemporaryFolder folder;
  const std::string block(size_t{1} << 20U, 'x');
  const std::string exact = *Sha256(folder.Write("exact", block));
  EXPECT_EQ(exact, *Sha256(folder.Write("again", block)));
  EXPECT_NE(exact, *Sha256(folder.Write("more", block + "x")));
}

TEST(HashTest, AMissingFileIsAnError) {
  const TemporaryFolder folder;
  EXPECT_THAT(Sha256(folder.path() / "none").error().message, ::testing::EndsWith("none: no such file"));
}

}  // namespace
}  // namespace scancal
