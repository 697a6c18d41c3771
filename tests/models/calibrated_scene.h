// A turntable with errors, calibrated.
#pragma once
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>
#include "io/units.h"
#include "models/turntable/calibrated_turntable.h"
#include "models/turntable/turntable_scanner.h"
#include "tests/models/turntable_scene.h"

namespace scancal {

// Standard uncertainties of what is considered, each large enough to show beside the noise.
inline const std::vector<std::pair<Turntable::Index, double>> kConsidered = {
    {Turntable::kTiltX, 2e-4},       {Turntable::kTiltY, 2e-4},       {Turntable::kScaleY, 1e-3},
    {Turntable::kScaleZ, 2e-4},      {Turntable::kShear, 2e-4},       {Turntable::kLinearity, 0.03},
    {Turntable::kEncoderCos1, 1e-4}, {Turntable::kEncoderSin1, 1e-4}, {Turntable::kEncoderCos2, 1e-4},
    {Turntable::kEncoderSin2, 1e-4}, {Turntable::kExpansion, 1e-4}};

inline Turntable ModelThatConsiders(const std::vector<std::pair<Turntable::Index, double>>& quantities) {
  Turntable model(Turntable::Residuals::kDepth);
  for (const auto& [k, u] : quantities) {
    model.quantity(k).role = Role::kConsider;
    model.quantity(k).u = u;
  }
  return model;
}

inline TurntableScene SmallScene() {
  TurntableScene scene;
  scene.profiles = 20;
  scene.points = 8;
  scene.sweep = 40 * kDegree;
  return scene;
}

// What a profiler with these errors shows of the scene, calibrated. q: by Turntable::Index.
inline Calibration Calibrated(TurntableScene scene, const Turntable& model, const std::vector<double>& q) {
  const double M = scene.system.M(), N = scene.system.N();
  std::copy_n(q.begin(), scene.system.q.size(), scene.system.q.begin());
  scene.system[Turntable::kM] = M;
  scene.system[Turntable::kN] = N;
  std::vector<Placement> placements;
  for (const SimulatedPlacement& simulated : SimulateTurntable(scene)) {
    Placement& placement = placements.emplace_back();
    placement.name = simulated.name;
    placement.profiles = Compress(simulated);
  }
  TurntableDeclaration declaration;
  declaration.search = {{M - 1, N - 1}, {M + 1, N + 1}, 1};
  const auto result = TurntableScanner(declaration, model, placements).Calibrate({});
  EXPECT_TRUE(result.ok()) << result.error().message;
  return result.ok() ? *result : Calibration();
}

inline std::vector<double> NoErrors() { return std::vector<double>(ModelThatConsiders({}).quantities().size(), 0.0); }

inline PointUncertainty PointsOf(const Calibration& calibration) {
  auto points = PointUncertainty::From(calibration);
  EXPECT_TRUE(points.ok()) << points.error().message;
  return *std::move(points);
}

}  // namespace scancal
