// Depth that drifts with time: told by sweeps there and back, else said; and what bends all profiles alike.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include "io/units.h"
#include "models/turntable/scanner.h"
#include "models/turntable/simulate.h"

namespace scancal::turntable {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<Placement> PlacementsOf(const Scene& scene) {
  std::vector<Placement> placements;
  for (const SimulatedPlacement& simulated : Simulate(scene)) {
    Placement& placement = placements.emplace_back();
    placement.name = simulated.name;
    for (const SimulatedProfile& raw : simulated.profiles) {
      placement.profiles.push_back(CompressProfile(raw.alpha, raw.y, raw.z, {}));
      placement.profiles.back().time = static_cast<double>(placement.profiles.size());
    }
  }
  return placements;
}

Calibration CalibrationOf(const Scene& scene, const std::function<void(Declaration*, Model*)>& declare = {}) {
  Declaration declaration;
  declaration.search = scene.search;
  Model model(Model::Residuals::kDepth);
  if (declare) declare(&declaration, &model);
  const Result<Calibration> result = Scanner(declaration, model, PlacementsOf(scene)).Calibrate({});
  EXPECT_TRUE(result.ok()) << result.error().message;
  return result.ok() ? *result : Calibration();
}

Scene SmallScene(uint64_t seed) {
  Scene scene;
  scene.profiles = 80;
  scene.points = 60;
  scene.seed = seed;
  return scene;
}

double InU(const Calibration& calibration, const char* name, double truth) {
  const Parameter& p = *calibration.Find(name);
  return (p.value - truth) / p.u;
}

TEST(Drift, IsEstimatedWhereSweepsGoThereAndBack) {
  double squares = 0;
  constexpr int kSets = 20;
  for (uint64_t seed = 1; seed <= kSets; ++seed) {
    Scene scene = SmallScene(seed);
    scene.back = true;
    scene.drift_sweep = 0.2;
    const Calibration calibration = CalibrationOf(scene, [](Declaration* d, Model*) { d->drift_declared = true; });
    EXPECT_TRUE(calibration.ok()) << calibration.unreliable.front();
    EXPECT_EQ(calibration.Find("drift_sweep")->role, Role::kEstimate);
    for (const auto& [name, truth] : {std::pair{"M", 123.0}, {"N", 409.0}, {"drift_sweep", 0.2}})
      squares += std::pow(InU(calibration, name, truth), 2) / (3 * kSets);
  }
  EXPECT_NEAR(squares, 1, 4 * std::sqrt(2.0 / (3 * kSets)));
}

TEST(Drift, ThatMayGoOnBetweenScansIsConsidered) {
  Scene scene = SmallScene(1);
  scene.back = true;
  scene.drift = 0.3;  // goes on
  const Calibration calibration = CalibrationOf(scene);
  EXPECT_NEAR(calibration.Find("drift_sweep")->value, 0.1, 0.01);
  EXPECT_NEAR(calibration.Find("drift")->u, 0.3 / std::sqrt(3.0), 0.02);
  for (const auto& [name, truth] : {std::pair{"M", 123.0}, {"N", 409.0}})
    EXPECT_LT(std::abs(InU(calibration, name, truth)), 2) << name;
  ASSERT_FALSE(calibration.notes.empty());
  EXPECT_THAT(calibration.notes.front().english, HasSubstr("Declare drift: 0 if it begins anew"));
}

// The shift that the note tells is the one that a drift makes.
TEST(Drift, OfOneWaySweepsIsSaid) {
  Scene scene = SmallScene(1);
  const Calibration without = CalibrationOf(scene);
  ASSERT_EQ(without.notes.size(), 2);  // and what a form would do
  scene.drift_sweep = 0.1;
  const Calibration with = CalibrationOf(scene);
  EXPECT_EQ(with.Find("drift_sweep")->role, Role::kHold);
  char expected[80];
  std::snprintf(expected, sizeof expected, "M would come out wrong by %+.2g mm",
                with.Find("M")->value - without.Find("M")->value);
  EXPECT_THAT(without.notes[0].english, HasSubstr(expected));
  const Calibration declared = CalibrationOf(scene, [](Declaration*, Model* model) {
    model->quantity(Model::kDriftSweep).role = Role::kConsider;
    model->quantity(Model::kDriftSweep).u = 0.1;
  });
  ASSERT_EQ(declared.notes.size(), 1);
  EXPECT_THAT(declared.notes[0].english, HasSubstr("form: plates"));
  EXPECT_LT(std::abs(InU(declared, "M", 123)), 2);
}

TEST(Drift, ThatIsHeldIsHeld) {
  Scene scene = SmallScene(1);
  scene.back = true;
  const Calibration calibration = CalibrationOf(scene, [](Declaration* d, Model*) { d->drift_held = true; });
  EXPECT_EQ(calibration.Find("drift_sweep")->role, Role::kHold);
}

TEST(Curvature, OfTheLensIsToldWhereItMovesSomething) {
  Scene scene = SmallScene(1);
  scene.system[Model::kLensYZ2] = 0.2;
  const Calibration calibration = CalibrationOf(scene);
  std::string all;
  for (const Sentence& sentence : calibration.unreliable) all += sentence.english + "\n";
  EXPECT_THAT(all, HasSubstr("lens_yz2"));
}

TEST(Curvature, OfNoiseIsNone) {
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    Scene scene = SmallScene(seed);
    if (seed % 2 == 0) scene.line_correlation = 20;
    const Calibration calibration = CalibrationOf(scene);
    EXPECT_TRUE(calibration.ok()) << seed << calibration.unreliable.front();
  }
}

}  // namespace
}  // namespace scancal::turntable
