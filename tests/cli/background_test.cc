// Background behind the plate: set aside, counted, and without influence (docs/uncertainty.md, section 5).
#include <gmock/gmock.h>
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class BackgroundTest : public CliTest {
 protected:
  BackgroundTest() { Simulate(data_, {"--profiles=60", "--points=40"}); }

  // The same as if the background had been deleted by hand.
  void ExpectAsDeleted(const Json& deleted, const Json& disturbed) const {
    for (const char* name : {"M", "N"}) {
      EXPECT_NEAR(ValueOf(disturbed, name), ValueOf(deleted, name), 0.2 * UOf(deleted, name)) << name;
      EXPECT_NEAR(UOf(disturbed, name), UOf(deleted, name), 0.2 * UOf(deleted, name)) << name;
    }
  }
  void ExpectUnmoved(const Json& clean, const Json& disturbed) const {
    for (const char* name : {"M", "N"}) {
      EXPECT_LT(std::abs(ValueOf(disturbed, name) - ValueOf(clean, name)), UOf(disturbed, name)) << name;
      EXPECT_LT(UOf(disturbed, name), 3 * UOf(clean, name)) << name;
    }
    EXPECT_LT(disturbed["sigma"], 1.3 * clean["sigma"].get<double>());
  }
  // Moves the points that `is_background` names by 40 mm, or by nan: profile and point are indices.
  size_t MoveAway(const std::function<bool(size_t profile, size_t point)>& is_background, double by = 40) const {
    size_t moved = 0;
    for (const std::string& name : kNames) {
      std::vector<ScanPoint> points;
      const auto profiles = Profiles(ReadPoints(data_ / (name + ".csv")));
      for (size_t k = 0; k < profiles.size(); ++k)
        for (size_t i = 0; i < profiles[k].size(); ++i) {
          points.push_back(profiles[k][i]);
          if (!is_background(k, i)) continue;
          points.back().y += by;
          ++moved;
        }
      WritePoints(data_ / (name + ".csv"), points);
    }
    return moved / kNames.size();
  }
  static void ExpectSetAside(const Json& result, size_t moved) {
    for (const Json& target : result["targets"]) {
      EXPECT_NEAR(target["set_aside"], static_cast<double>(moved), 3) << target["name"];
      EXPECT_NEAR(target["points"], static_cast<double>(2400 - moved), 3) << target["name"];
    }
  }

  const fs::path data_ = Path("data");
};

TEST_F(BackgroundTest, ThirtyPercentOfEveryLine) {
  const Json clean = Refined(data_);
  const size_t moved = MoveAway([](size_t, size_t i) { return i < 12; });
  EXPECT_EQ(moved, 720U);
  const Json disturbed = Refined(data_);
  ExpectSetAside(disturbed, moved);
  ExpectUnmoved(clean, disturbed);
  EXPECT_THAT(disturbed["targets"][0]["set_aside_reasons"].dump(), HasSubstr("off the line"));
}

TEST_F(BackgroundTest, ThirtyPercentOfTheProfiles) {
  const Json clean = Refined(data_);
  const size_t moved = MoveAway([](size_t k, size_t) { return k < 18; });
  EXPECT_EQ(moved, 720U);
  const Json disturbed = Refined(data_);
  ExpectSetAside(disturbed, moved);
  ExpectUnmoved(clean, disturbed);
  EXPECT_THAT(disturbed["targets"][0]["set_aside_reasons"].dump(), HasSubstr("off the plane"));
}

TEST_F(BackgroundTest, ThirtyPercentOfTheProfilesInTheMiddle) {
  const Json clean = Refined(data_);
  const size_t moved = MoveAway([](size_t k, size_t) { return k >= 20 && k < 38; });
  const Json disturbed = Refined(data_);
  ExpectSetAside(disturbed, moved);
  ExpectUnmoved(clean, disturbed);
}

TEST_F(BackgroundTest, PartOfTheLineInPartOfTheProfiles) {
  const auto is_background = [](size_t k, size_t i) { return (k < 12) || (k >= 40 && i >= 24); };
  const size_t moved = MoveAway(is_background);
  EXPECT_EQ(moved, 12U * 40 + 20 * 16);
  const Json disturbed = Refined(data_);
  ExpectSetAside(disturbed, moved);
  MoveAway(is_background, std::nan(""));
  const Json deleted = Refined(data_);
  EXPECT_EQ(deleted["targets"][0]["missing"], moved);
  ExpectAsDeleted(deleted, disturbed);
}

// Against the same scans with the background deleted: what remains of the points, not of the plate, makes another
// estimate than all points do.
TEST_F(BackgroundTest, AWallAtEitherEndOfEveryLine) {
  for (const std::string seed : {"2", "3"}) {
    Simulate(data_, {"--profiles=60", "--points=40", "--seed=" + seed});
    const fs::path disturbed_data = Path("disturbed");
    Simulate(disturbed_data, {"--profiles=60", "--points=40", "--seed=" + seed, "--background=0.3"});
    for (const std::string& name : kNames) {
      std::vector<ScanPoint> points = ReadPoints(data_ / (name + ".csv"));
      const std::vector<ScanPoint> disturbed = ReadPoints(disturbed_data / (name + ".csv"));
      for (size_t i = 0; i < points.size(); ++i)
        if (disturbed[i].y > points[i].y + 1) points[i].y = std::nan("");
      WritePoints(data_ / (name + ".csv"), points);
    }
    const Json deleted = Refined(data_), disturbed = Refined(disturbed_data);
    EXPECT_EQ(deleted["targets"][0]["missing"], 720);
    ExpectSetAside(disturbed, 720);
    ExpectAsDeleted(deleted, disturbed);
  }
}

TEST_F(BackgroundTest, TheCountsArePrinted) {
  MoveAway([](size_t, size_t i) { return i < 12; });
  EXPECT_THAT(Refine(data_).out,
              AllOf(HasSubstr("2160 set aside"), HasSubstr("set aside: left: 720 points off the line")));
}

}  // namespace
}  // namespace scancal
