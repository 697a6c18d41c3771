// An artifact measured with a calibrated turntable.
#include "tests/coverage/verify.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include "models/turntable/artifact.h"
#include "tests/models/turntable/calibrated.h"

namespace scancal::turntable {
namespace {

using ::testing::HasSubstr;

Calibration Sound() {
  Scene scene = SmallScene();
  scene.noise_y = 0.03;
  scene.encoder_jitter = 3e-5;
  return Calibrated(scene, ModelThatConsiders({{Model::kScaleY, 1e-3}}), NoErrors());
}
Instrument TrueInstrument() { return {.system = SmallScene().system}; }
// Two balls of 25.4 mm and a step of 20 mm, the one within its tolerance, the other not.
Artifact SeenBy(const Instrument& instrument) {
  Artifact artifact = SeeArtifact(instrument, 0.002, 1);
  artifact.features[0].tolerance = {-0.05, 0.05};
  artifact.features[2].tolerance = {-1, -0.9};
  return artifact;
}
// A scale of depth, which M and N follow, scales what lies in the plane of the table: of the bar, which rises by 110
// mm, d length / d scale over its length of 197.336 mm.
const double kBarInPlane = 1 - std::pow(110 / 197.336, 2);
Verification Verified(const Calibration& calibration, const Artifact& artifact) {
  const auto result = VerifyFeatures(calibration, artifact.targets, artifact.features);
  EXPECT_TRUE(result.ok()) << result.error().message;
  return result.ok() ? *result : Verification();
}

TEST(VerifyFeatures, AgreeWithTheirReferenceAndSayWhatUComesFrom) {
  const Verification found = Verified(Sound(), SeenBy(TrueInstrument()));
  ASSERT_EQ(found.features.size(), 3U);
  for (const VerifiedFeature& f : found.features) {
    EXPECT_LT(std::abs(f.E_n), 1.5) << f.name;  // three standard deviations
    EXPECT_LT(std::abs(f.deviation()), 0.5) << f.name;
    EXPECT_NEAR(f.u, std::hypot(f.u_calibration, f.u_noise, f.u_reference), 1e-12);
    EXPECT_GT(f.u_noise, 0);
    EXPECT_NEAR(f.form, 0.03, 0.015) << f.name;
  }
  const VerifiedFeature& bar = found.features[1];
  EXPECT_NEAR(bar.u_calibration, 1e-3 * kBarInPlane * bar.nominal, 0.02e-3 * bar.nominal);
  EXPECT_EQ(found.features[0].conformity->decision, Decision::kAccept);
  EXPECT_EQ(found.features[2].conformity->decision, Decision::kReject);
  EXPECT_TRUE(found.out());
  EXPECT_TRUE(found.notes.empty()) << found.notes[0];
}

TEST(VerifyFeatures, PlanesCannotSeeScaleAndTheseFeaturesDo) {
  constexpr double kScale = 1e-3;
  Scene scene = SmallScene();
  scene.noise_y = 0.03;
  scene.encoder_jitter = 3e-5;
  std::vector<double> q = NoErrors();
  q[Model::kScaleY] = kScale;
  Instrument instrument = TrueInstrument();
  instrument.system[Model::kScaleY] = kScale;
  const Artifact artifact = SeenBy(instrument);
  for (const bool considered : {false, true}) {
    const Model model = considered ? ModelThatConsiders({{Model::kScaleY, 1e-3}}) : ModelThatConsiders({});
    const Verification found = Verified(Calibrated(scene, model, q), artifact);
    ASSERT_TRUE(found.scale.has_value());
    EXPECT_NEAR(found.scale->value, kScale, 1.5 * found.scale->U) << considered;
    EXPECT_LT(found.scale->U, 0.6 * kScale) << considered;
    EXPECT_NEAR(found.features[1].deviation() / found.features[1].nominal, -kScale * kBarInPlane, 0.3 * kScale);
    if (!considered) {
      EXPECT_TRUE(found.features[1].out());  // nobody declared it: u is too small, and E_n says so
    }
  }
}

TEST(VerifyFeatures, WhatIsNotOnTheShapeIsSetAsideAndRoughOnesHaveMoreU) {
  Artifact artifact = SeenBy(TrueInstrument());
  const Verification clean = Verified(Sound(), artifact);
  for (const size_t t : {0, 2}) {
    SensorColumns& points = artifact.targets[t].points;
    for (size_t i = 0; i < points.y.size(); i += 5) points.y[i] += 8;  // a stem, an edge
  }
  const Verification with_stem = Verified(Sound(), artifact);
  EXPECT_GT(with_stem.features[0].set_aside, artifact.targets[0].points.y.size() / 6);
  EXPECT_GT(with_stem.features[2].set_aside, artifact.targets[2].points.y.size() / 6);
  for (const size_t k : {0, 2}) EXPECT_NEAR(with_stem.features[k].measured, clean.features[k].measured, 0.05) << k;
  Instrument rough = TrueInstrument();
  rough.noise_y = 0.15;
  const Verification noisy = Verified(Sound(), SeenBy(rough));
  EXPECT_GT(noisy.features[0].u_noise, 3 * clean.features[0].u_noise);
  ASSERT_FALSE(noisy.notes.empty());
  EXPECT_THAT(noisy.notes[0], HasSubstr("times as much as the calibration's noise"));
  Instrument in_patches = TrueInstrument();
  in_patches.line_correlation = 9;  // points of a profile err alike: no point scatters more
  const Verification alike = Verified(Sound(), SeenBy(in_patches));
  EXPECT_GT(alike.features[2].u_noise, 2 * clean.features[2].u_noise);
  EXPECT_NEAR(alike.features[2].form, clean.features[2].form, 0.2 * clean.features[2].form);
}

TEST(VerifyFeatures, WhatPointsDoNotDetermineIsRefused) {
  Artifact artifact = SeenBy(TrueInstrument());
  for (size_t t = 0; t < 3; t += 2) {
    Artifact cut = artifact;
    for (auto* column : {&cut.targets[t].points.alpha, &cut.targets[t].points.y, &cut.targets[t].points.z})
      column->resize(3);
    const auto refused = VerifyFeatures(Sound(), cut.targets, cut.features);
    ASSERT_FALSE(refused.ok());
    EXPECT_THAT(refused.error().message, HasSubstr("target " + cut.targets[t].name + ": found 3 points"));
  }
  Calibration equal = Sound();
  equal.budget.clear();
  for (Parameter& p : equal.parameters)
    if (p.role == Role::kConsider) p.u = 0;
  const auto refused = VerifyFeatures(equal, artifact.targets, artifact.features);
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message, HasSubstr("no noise_y"));
}

// The full count: scripts/coverage --verify.
TEST(VerifyFeatures, StatedIntervalsHoldInRepeatedCalibrations) {
  constexpr size_t kSets = 120;
  // Intervals of 95 % fall short of this count once in 10,000 right runs.
  const double least = boost::math::quantile(boost::math::binomial(kSets, 0.95), 1e-4);
  const auto counts = coverage::CountVerified(kSets);
  ASSERT_EQ(counts.size(), 4U);
  for (const auto& [kind, count] : counts) EXPECT_GE(count.within, least) << kind;
  // And are not too wide: the mean square of E_n is that of a normal distribution over its U.
  for (const auto& [kind, count] : counts)
    EXPECT_NEAR(count.squares / kSets * 1.96 * 1.96, 1, 4 * std::sqrt(2.0 / kSets)) << kind;
}

}  // namespace
}  // namespace scancal::turntable
