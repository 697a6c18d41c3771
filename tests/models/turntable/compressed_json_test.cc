// Compressed data survive their file to the last bit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include "io/input_file.h"
#include "io/json_file.h"
#include "models/turntable/compress.h"
#include "tests/models/turntable/scene.h"

namespace scancal::turntable {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::vector<Placement> Placements(bool lidar) {
  Scene scene;
  scene.profiles = 7;
  scene.points = 30;
  std::vector<Placement> placements;
  for (const SimulatedPlacement& simulated : Simulate(scene)) {
    RawScan scan;
    scan.name = simulated.name;
    scan.missing = 3;
    scan.warnings = {{"a warning \"with\" quotes", lidar ? "eine Warnung" : "", lidar ? "some.warning" : ""}};
    if (lidar) scan.warnings.push_back({"another"});
    for (const SimulatedProfile& profile : simulated.profiles) {
      RawProfile& raw = scan.profiles.emplace_back();
      raw.alpha = profile.alpha;
      raw.y = profile.y;
      raw.z = profile.z;
      for (double& y : raw.y) y += lidar ? 1000 : 0;
      if (lidar)
        for (size_t i = 0; i < raw.y.size(); ++i) raw.range.push_back(std::hypot(raw.y[i], raw.z[i]));
    }
    scan.profiles[2].y.resize(1);  // one point, one segment
    scan.profiles[2].z.resize(1);
    if (lidar) scan.profiles[2].range.resize(1);
    Clean(&scan);
    scan.off_line = 5;
    const PointsOnPlane points = SetAsideOffPlane(scan, scene.system);
    placements.push_back(MakePlacement(scan, points));
    LookAtResiduals(scan, points, &placements.back());
  }
  return placements;
}

void ExpectSame(const Profile& a, const Profile& b) {
  EXPECT_EQ(a.alpha, b.alpha);
  EXPECT_EQ(a.count, b.count);
  EXPECT_EQ(a.segments, b.segments);
  EXPECT_EQ(a.factor, b.factor);
  EXPECT_EQ(a.ranged, b.ranged);
  EXPECT_EQ(a.pure_error.sum_of_squares, b.pure_error.sum_of_squares);
  EXPECT_EQ(a.pure_error.dof, b.pure_error.dof);
}

TEST(CompressedData, ComeBackToTheLastBit) {
  for (const bool lidar : {false, true}) {
    const std::vector<Placement> before = Placements(lidar);
    EXPECT_EQ(before[0].IsLidar(), lidar);
    EXPECT_GT(before[0].lag_sums.products.size(), 5U);
    const auto json = PlacementsToJson(before);
    ASSERT_TRUE(json.ok());
    const auto after = PlacementsFromJson(Json::parse(json->dump(2)), "f");  // through text, as on disk
    ASSERT_TRUE(after.ok()) << after.error().message;
    ASSERT_EQ(after->size(), before.size());
    for (size_t t = 0; t < before.size(); ++t) {
      const Placement &a = before[t], &b = (*after)[t];
      EXPECT_EQ(a.name, b.name);
      EXPECT_EQ(a.missing, b.missing);
      EXPECT_EQ(a.set_aside, b.set_aside);
      EXPECT_EQ(a.largest, b.largest);
      EXPECT_EQ(a.warnings, b.warnings);
      EXPECT_EQ(a.lag_sums.products, b.lag_sums.products);
      EXPECT_EQ(a.lag_sums.pairs, b.lag_sums.pairs);
      EXPECT_EQ(a.lag_sums.absorbed, b.lag_sums.absorbed);
      EXPECT_EQ(a.histogram.scale, b.histogram.scale);
      EXPECT_EQ(a.histogram.counts, b.histogram.counts);
      ASSERT_EQ(a.profiles.size(), b.profiles.size());
      for (size_t k = 0; k < a.profiles.size(); ++k) ExpectSame(a.profiles[k], b.profiles[k]);
    }
  }
}

TEST(CompressedData, AWarningOfAnOldFileIsEnglishAlone) {
  Json json = *PlacementsToJson(Placements(true));
  EXPECT_EQ(json["targets"][0]["warning"]["de"], "eine Warnung");
  json["targets"][0]["warning"] = "an old warning";
  json["targets"][0].erase("more_warnings");
  EXPECT_EQ((*PlacementsFromJson(json, "f"))[0].warnings, std::vector{Sentence{"an old warning"}});
}

// Numbers that carry their right hash, yet cannot be: nothing but the program's own check is left.
TEST(CompressedData, NumbersThatCannotBeAreRefused) {
  const Json sound = *PlacementsToJson(Placements(false));
  const std::string bytes = *FromBase64(sound["segments"].get<std::string>());
  const auto error_of = [&](const std::string& changed) {
    Json json = sound;
    json["segments"] = ToBase64(changed);
    json["sha256"] = *Sha256OfText(json["segments"].get<std::string>());
    const auto placements = PlacementsFromJson(json, "some.json");
    return placements.ok() ? "" : placements.error().message;
  };
  EXPECT_EQ(error_of(bytes), "");
  const auto refused = AllOf(StartsWith("some.json: data: segments: found other numbers"), HasSubstr("another copy"));
  EXPECT_THAT(error_of(""), refused);
  EXPECT_THAT(error_of(bytes.substr(0, bytes.size() / 2)), refused);
  EXPECT_THAT(error_of(bytes + std::string(8, '\0')), refused);
  EXPECT_THAT(error_of(bytes + "x"), refused);
  for (const std::string& number : {std::string(8, '\xff'), std::string(8, '\0')})  // nan, 0
    for (const size_t at : {size_t{0}, bytes.size() - 6 * 8})                       // number of lags, last r00
      EXPECT_THAT(error_of(std::string(bytes).replace(at, 8, number)), refused) << at;
}

TEST(CompressedData, TargetsThatCannotBeAreRefused) {
  const Json sound = *PlacementsToJson(Placements(false));
  for (const char* patch :
       {R"({"name": 5})", R"({"missing": -1})", R"({"missing": 1.5})", R"({"set_aside": []})",
        R"({"set_aside": {"off": "many"}})", R"({"largest": null})", R"({"lidar": 0})", R"({"profiles": 0})",
        R"({"profiles": "7"})", R"({"warning": null})", R"({"warning": {"en": "a"}})"}) {
    Json json = sound;
    json["targets"][1].update(Json::parse(patch));
    const auto placements = PlacementsFromJson(json, "some.json");
    ASSERT_FALSE(placements.ok()) << patch;
    EXPECT_THAT(placements.error().message, StartsWith("some.json: data: target 2: expected name, missing")) << patch;
  }
  for (const char* patch : {R"({"profiles": 6})", R"({"profiles": 1000000000000})", R"({"lidar": true})"}) {
    Json json = sound;
    json["targets"][1].update(Json::parse(patch));
    EXPECT_FALSE(PlacementsFromJson(json, "some.json").ok()) << patch;
  }
}

}  // namespace
}  // namespace scancal::turntable
