#include "tests/coverage/verify.h"
#include <glog/logging.h>
#include <cmath>
#include "io/units.h"
#include "models/turntable/artifact.h"
#include "models/turntable/scanner.h"
#include "solver/random.h"

namespace scancal::coverage {

using turntable::Model;

std::map<std::string, double> TryVerify(uint64_t seed) {
  static const std::vector<std::pair<Model::Index, double>> kErrors = {
      {Model::kScaleY, 2e-4}, {Model::kTiltX, 2e-4}, {Model::kTiltY, 2e-4}, {Model::kEncoderCos1, 5e-5}};
  Random random(seed, 9);
  Model model(Model::Residuals::kDepth);
  turntable::Instrument instrument;
  turntable::Scene scene;
  scene.profiles = 40;
  scene.points = 20;
  scene.sweep = 40 * kDegree;
  scene.seed = seed;
  scene.noise_y = instrument.noise_y;
  scene.encoder_jitter = instrument.encoder_jitter;
  for (const auto& [k, u] : kErrors) {
    model.quantity(k).role = Role::kConsider;
    model.quantity(k).u = u;
    scene.system[k] = u * random.Normal();
  }
  instrument.system = scene.system;
  std::vector<turntable::Placement> placements;
  for (const turntable::SimulatedPlacement& simulated : turntable::Simulate(scene)) {
    turntable::Placement& placement = placements.emplace_back();
    placement.name = simulated.name;
    for (const turntable::SimulatedProfile& profile : simulated.profiles)
      placement.profiles.push_back(turntable::CompressProfile(profile.alpha, profile.y, profile.z, {}));
  }
  turntable::Declaration declaration;
  declaration.search = {{scene.system.M() - 1, scene.system.N() - 1}, {scene.system.M() + 1, scene.system.N() + 1}, 1};
  const auto calibration = turntable::Scanner(declaration, model, placements).Calibrate({});
  CHECK(calibration.ok()) << calibration.error().message;
  const turntable::Artifact artifact = turntable::SeeArtifact(instrument, 0.002, seed);
  const auto verification = turntable::VerifyFeatures(*calibration, artifact.targets, artifact.features);
  CHECK(verification.ok()) << verification.error().message;
  std::map<std::string, double> e_n;
  for (const VerifiedFeature& feature : verification->features) e_n[feature.kind] = feature.E_n;
  CHECK(verification->scale.has_value());
  e_n["scale_y"] = (verification->scale->value - instrument.system[Model::kScaleY]) / verification->scale->U;
  return e_n;
}

std::map<std::string, VerifyCount> CountVerified(size_t sets) {
  std::map<std::string, VerifyCount> counts;
  for (size_t k = 1; k <= sets; ++k) {
    for (const auto& [kind, e_n] : TryVerify(k)) {
      VerifyCount& count = counts[kind];
      count.within += std::abs(e_n) <= 1;
      count.squares += e_n * e_n;
      ++count.trials;
    }
  }
  return counts;
}

}  // namespace scancal::coverage
