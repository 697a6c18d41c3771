// What is said, in both languages.
#include "solver/sentence.h"
#include <gtest/gtest.h>
#include <limits>

namespace scancal {
namespace {

constexpr Message<std::string_view, Sentence, double> kBall{"test.ball", "{} is {}, {:.2g} mm off",
                                                            "{} ist {}, {:.2g} mm daneben"};
constexpr Message<> kLoose{"test.loose", "loose", "locker"};
constexpr Message<double, int> kNumbers{"test.numbers", "{} of {}", "{} von {}"};

TEST(Sentence, EachArgumentStandsInBothLanguages) {
  const Sentence said = Say(kBall, "ball.1", Say(kLoose), -0.1234);
  EXPECT_EQ(said.id, "test.ball");
  EXPECT_EQ(said.english, "ball.1 is loose, -0.12 mm off");
  EXPECT_EQ(said.german, "ball.1 ist locker, -0,12 mm daneben");  // a name keeps its point
}

TEST(Sentence, WordsOfOthersStayAsTheyAre) {
  const Sentence said = Say(kBall, "b", Sentence{"as Ceres says."}, 1);
  EXPECT_EQ(said.english, "b is as Ceres says., 1 mm off");
  EXPECT_EQ(said.german, "b ist as Ceres says., 1 mm daneben");
}

TEST(Sentence, NumbersOfEverySize) {
  const auto german = [](double number) { return Say(kNumbers, number, 1200000).german; };
  EXPECT_EQ(german(1e-16), "1e-16 von 1200000");
  EXPECT_EQ(german(1.5e-7), "1,5e-07 von 1200000");
  EXPECT_EQ(german(std::numeric_limits<double>::infinity()), "inf von 1200000");
  EXPECT_EQ(german(std::numeric_limits<double>::quiet_NaN()), "nan von 1200000");
  EXPECT_EQ(Say(kNumbers, 1.5e-7, 2).english, "1.5e-07 of 2");
}

TEST(Sentence, ReadsAsItsEnglish) {
  const Sentence said = Say(kLoose);
  const std::string& text = said;
  EXPECT_EQ(text, "loose");
  EXPECT_FALSE(said.empty());
  EXPECT_TRUE(Sentence{}.empty());
}

}  // namespace
}  // namespace scancal
