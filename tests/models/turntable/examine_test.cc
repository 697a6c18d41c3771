// Copies, undeclared marks of missing points, rounded and wound angles; and honest data that look like them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <numeric>
#include "io/units.h"
#include "models/turntable/compress.h"
#include "models/turntable/simulate.h"

namespace scancal::turntable {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

double Rounded(double value, double step) { return step > 0 ? std::round(value / step) * step : value; }

// Of the same place again and again, with noise of its own each time.
RawScan ScanOf(uint64_t seed, double noise, double step, int profiles = 40, bool lidar = false) {
  Random random(seed, 0);
  RawScan scan;
  scan.name = "scan " + std::to_string(seed);
  for (int i = 0; i < profiles; ++i) {
    RawProfile& profile = scan.profiles.emplace_back();
    profile.key = profile.time = i;
    profile.alpha = (i - profiles / 2) * 0.25 * kDegree;
    for (int j = 0; j < 60; ++j) {
      const double bearing = (j - 30) * 0.5 * kDegree;
      if (lidar) {
        const double range = Rounded((1000 + 3 * i + noise * random.Normal()) / std::cos(bearing), step);
        profile.range.push_back(range);
        profile.y.push_back(range * std::cos(bearing));
        profile.z.push_back(range * std::sin(bearing));
      } else {
        profile.z.push_back(3 * j - 90);
        profile.y.push_back(Rounded(70 + 0.8 * i + 0.1 * j + noise * random.Normal(), step));
      }
    }
  }
  return scan;
}

// The sweep twice, the second time as `change` makes it.
template <class Change>
RawScan Twice(RawScan scan, const Change& change) {
  const std::vector<RawProfile> first = scan.profiles;
  for (RawProfile profile : first) {
    profile.key += 1000;
    profile.time += 1000;
    change(&profile);
    scan.profiles.push_back(std::move(profile));
  }
  Clean(&scan);
  return scan;
}

double LeftOf(RawScan scan) {
  std::vector<RawScan> scans = {std::move(scan)};
  DropCopies(&scans);
  EXPECT_EQ(scans[0].profiles.size(), scans[0].compressed.size());
  EXPECT_EQ(scans[0].warnings.empty(), scans[0].copied == 0);
  return static_cast<double>(scans[0].compressed.size());
}

TEST(Copies, OfLinesCountOnce) {
  for (const double step : {1e-4, 0.0, 0.02}) {
    EXPECT_EQ(LeftOf(Twice(ScanOf(1, 0.05, step), [](RawProfile*) {})), 40) << step;
    EXPECT_EQ(LeftOf(Twice(ScanOf(1, 0.05, step), [](RawProfile* p) { p->alpha += 1e-5; })), 40) << step;
  }
}

TEST(Copies, MayBeRoundedOrShiftedByARounding) {
  for (const double to : {1e-3, 1e-2})
    EXPECT_EQ(LeftOf(Twice(ScanOf(1, 0.05, 1e-4),
                           [&](RawProfile* p) {
                             for (double& y : p->y) y = Rounded(y, to);
                           })),
              40)
        << to;
  EXPECT_EQ(LeftOf(Twice(ScanOf(1, 0.05, 1e-4),
                         [](RawProfile* p) {
                           for (double& y : p->y) y += 4e-5;
                         })),
            40);
}

TEST(Copies, OfPointsCountOnce) {
  RawScan scan = ScanOf(1, 0.05, 1e-4);
  for (RawProfile& profile : scan.profiles)
    for (auto* column : {&profile.y, &profile.z}) {
      std::vector<double> twice;
      for (const double value : *column) twice.insert(twice.end(), 2, value);
      *column = twice;
    }
  Clean(&scan);
  std::vector<RawScan> scans = {scan};
  DropCopies(&scans);
  EXPECT_EQ(scans[0].compressed[7].count, 60);
  EXPECT_EQ(scans[0].copied, 40 * 60);
}

TEST(Copies, OfAWholeTargetAreLeftOut) {
  std::vector<RawScan> scans = {ScanOf(1, 0.05, 1e-4), ScanOf(2, 0.05, 1e-4), ScanOf(1, 0.05, 1e-4)};
  scans[2].name = "again";
  scans[2].profiles.resize(30);
  for (RawScan& scan : scans) Clean(&scan);
  DropCopies(&scans);
  ASSERT_EQ(scans.size(), 2);
  ASSERT_EQ(scans[0].warnings.size(), 1);
  EXPECT_THAT(scans[0].warnings[0].english, HasSubstr("target again is a copy of target scan 1"));
  EXPECT_THAT(scans[1].warnings, IsEmpty());
}

// A lidar with steps of 1 mm: with little noise it repeats itself, with much it cannot.
TEST(Copies, AreNotWhatRepeatsItselfHonestly) {
  for (const double noise : {0.0, 0.05, 0.2, 0.4, 1.0, 5.0}) {
    RawScan again = ScanOf(2, noise, 1, 40, true);
    size_t k = 0;
    const RawScan both = Twice(ScanOf(1, noise, 1, 40, true), [&](RawProfile* p) {
      const RawProfile& other = again.profiles[k++];
      p->y = other.y;
      p->z = other.z;
      p->range = other.range;
    });
    EXPECT_EQ(LeftOf(both), 80) << noise;
  }
  for (const double noise : {1.0, 5.0})
    EXPECT_EQ(LeftOf(Twice(ScanOf(1, noise, 1, 40, true), [](RawProfile*) {})), 40) << noise;
}

TEST(Copies, AreNotASweepBack) {
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    const RawScan again = ScanOf(seed + 1000, 0.02, 1e-3);
    size_t k = 0;
    const RawScan both = Twice(ScanOf(seed, 0.02, 1e-3), [&](RawProfile* p) { p->y = again.profiles[k++].y; });
    EXPECT_EQ(LeftOf(both), 80) << seed;
  }
}

TEST(Copies, AreNotDataWithoutNoise) {
  EXPECT_EQ(LeftOf(Twice(ScanOf(1, 0, 0), [](RawProfile*) {})), 80);
}

TEST(RepeatedValue, IsAnUndeclaredInvalid) {
  for (const double value : {-99.9999, 0.0, 65.533}) {
    for (const double share : {0.05, 0.3, 0.8}) {
      RawScan scan = ScanOf(1, 0.05, 1e-4);
      Random random(3, 0);
      for (RawProfile& profile : scan.profiles)
        for (double& y : profile.y)
          if (random.Uniform() < share) y = value;
      ASSERT_TRUE(RepeatedValue(scan.profiles).has_value()) << value << ' ' << share;
      EXPECT_EQ(*RepeatedValue(scan.profiles), value);
    }
  }
}

TEST(RepeatedValue, IsNoSurface) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    for (const double noise : {0.0, 0.1, 1.0, 5.0}) {
      EXPECT_FALSE(RepeatedValue(ScanOf(seed, noise, 1, 40, true).profiles)) << noise;
      EXPECT_FALSE(RepeatedValue(ScanOf(seed, noise, 1).profiles)) << noise;
      EXPECT_FALSE(RepeatedValue(ScanOf(seed, noise / 10, 1e-4).profiles)) << noise;
    }
  }
}

// Profiles of `each` in a row at one angle.
RawScan Merged(double noise, int each, bool turns) {
  const RawScan from = ScanOf(1, noise, 1e-4);
  RawScan scan;
  scan.name = "merged";
  for (size_t k = 0; k < from.profiles.size(); k += static_cast<size_t>(each)) {
    RawProfile& profile = scan.profiles.emplace_back(from.profiles[k]);
    Random random(k, 1);
    for (size_t i = 1; i < static_cast<size_t>(each) && k + i < from.profiles.size(); ++i) {
      for (size_t j = 0; j < profile.z.size() / i && j < 60; ++j) {
        profile.z.push_back(from.profiles[k + i].z[j]);
        profile.y.push_back(turns ? from.profiles[k + i].y[j] : from.profiles[k].y[j] + noise * random.Normal());
      }
    }
  }
  return scan;
}

TEST(RoundedAngles, SplitProfilesThatWereTakenWhileItTurned) {
  RawScan scan = Merged(0.05, 2, true);
  SplitAtRoundedAngles(&scan);
  EXPECT_EQ(scan.profiles.size(), 40);
  EXPECT_EQ(scan.profiles[0].alpha, scan.profiles[1].alpha);
  Clean(&scan);
  NoteRoundedAngles(&scan);
  ASSERT_EQ(scan.warnings.size(), 1);
  EXPECT_THAT(scan.warnings[0].english, HasSubstr("steps of 0.5 deg, and 40 profiles were taken at 20 of them"));
}

TEST(RoundedAngles, AreNotATableThatStandsStill) {
  for (const double noise : {0.0, 0.005, 0.05}) {
    RawScan scan = Merged(noise, 2, false);
    SplitAtRoundedAngles(&scan);
    EXPECT_EQ(scan.profiles.size(), 20) << noise;
    NoteRoundedAngles(&scan);
    EXPECT_THAT(scan.warnings, IsEmpty());
  }
}

TEST(Unwind, GivesOneSweep) {
  const std::vector<double> angles = {-10, -5, -0.25, 0, 0.25, 5, 10};
  const auto scan_at = [&](const std::function<double(double)>& written) {
    RawScan scan;
    for (const double angle : angles) {
      RawProfile& profile = scan.profiles.emplace_back();
      profile.alpha = written(angle) * kDegree;
      profile.y = {70, 71};
      profile.z = {0, 1};
    }
    Clean(&scan);
    return scan;
  };
  std::vector<RawScan> scans = {
      scan_at([](double a) { return a; }), scan_at([](double a) { return a < 0 ? a + 360 : a; }),
      scan_at([](double a) { return a + 720; }), scan_at([](double a) { return a + (a > 0 ? 1080 : 360); })};
  Unwind(&scans);
  for (const RawScan& scan : scans) {
    for (size_t k = 0; k < angles.size(); ++k) {
      EXPECT_NEAR(scan.compressed[k].alpha, angles[k] * kDegree, 1e-12);
      EXPECT_EQ(scan.profiles[k].alpha, scan.compressed[k].alpha);
    }
  }
  // What is seen all around is no wrap.
  std::vector<RawScan> round = {scan_at([](double a) { return 18 * a; })};
  Unwind(&round);
  for (size_t k = 0; k < angles.size(); ++k) EXPECT_EQ(round[0].compressed[k].alpha, 18 * angles[k] * kDegree);
}

}  // namespace
}  // namespace scancal::turntable
