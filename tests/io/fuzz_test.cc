// Every reader on its corpus, and on bytes made of it with a fixed seed: no crash, no hang. scripts/fuzz goes further.
#include <gmock/gmock.h>
#include <chrono>
#include <fstream>
#include <iterator>
#include <random>
#include "tests/fuzz/readers.h"

namespace scancal {
namespace {

class FuzzTest : public ::testing::TestWithParam<FuzzedReader> {};

std::vector<std::string> Corpus(const std::string& reader) {
  std::vector<std::string> corpus;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(SCANCAL_SOURCE_DIR) + "/tests/fuzz/corpus/" + reader)) {
    std::ifstream file(entry.path(), std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  std::sort(corpus.begin(), corpus.end());
  return corpus;
}

// One to four places changed, removed, doubled, or taken from another.
std::string Mutant(const std::vector<std::string>& corpus, std::mt19937* random) {
  const auto below = [&](size_t n) { return n == 0 ? 0 : static_cast<size_t>((*random)() % n); };
  std::string bytes = corpus[below(corpus.size())];
  for (size_t k = 0, times = 1 + below(4); k < times; ++k) {
    const std::string& other = corpus[below(corpus.size())];
    const size_t at = below(bytes.size() + 1), length = below(9);
    switch (below(4)) {
      case 0:
        bytes.insert(at, 1, static_cast<char>((*random)()));
        break;
      case 1:
        bytes.erase(at, length);
        break;
      case 2:
        bytes.insert(at, bytes.substr(below(bytes.size()), length));
        break;
      default:
        bytes.replace(at, length, other.substr(below(other.size()), length));
    }
  }
  return bytes;
}

TEST_P(FuzzTest, EndsWithAValueOrASentence) {
  const std::vector<std::string> corpus = Corpus(GetParam().name);
  ASSERT_FALSE(corpus.empty());
  for (const std::string& bytes : corpus) GetParam().read(bytes);
  std::mt19937 random(1);
  const auto began = std::chrono::steady_clock::now();
  for (int k = 0; k < 500; ++k) GetParam().read(Mutant(corpus, &random));
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::minutes(1));
}

INSTANTIATE_TEST_SUITE_P(Readers, FuzzTest, ::testing::ValuesIn(kFuzzedReaders),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace scancal
