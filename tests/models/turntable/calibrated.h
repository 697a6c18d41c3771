// A turntable with errors, calibrated.
#pragma once
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>
#include "io/units.h"
#include "models/turntable/scanner.h"
#include "models/turntable/use.h"
#include "tests/models/turntable/scene.h"

namespace scancal::turntable {

// Standard uncertainties of what is considered, each large enough to show beside the noise.
inline const std::vector<std::pair<Model::Index, double>> kConsidered = {
    {Model::kTiltX, 2e-4},       {Model::kTiltY, 2e-4},       {Model::kScaleY, 1e-3},      {Model::kScaleZ, 2e-4},
    {Model::kShear, 2e-4},       {Model::kLinearity, 0.03},   {Model::kEncoderCos1, 1e-4}, {Model::kEncoderSin1, 1e-4},
    {Model::kEncoderCos2, 1e-4}, {Model::kEncoderSin2, 1e-4}, {Model::kExpansion, 1e-4}};

inline Model ModelThatConsiders(const std::vector<std::pair<Model::Index, double>>& quantities) {
  Model model(Model::Residuals::kDepth);
  for (const auto& [k, u] : quantities) {
    model.quantity(k).role = Role::kConsider;
    model.quantity(k).u = u;
  }
  return model;
}

inline Scene SmallScene() {
  Scene scene;
  scene.profiles = 20;
  scene.points = 8;
  scene.sweep = 40 * kDegree;
  return scene;
}

// What a profiler with these errors shows of the scene, calibrated. q: by Model::Index.
inline Calibration Calibrated(Scene scene, const Model& model, const std::vector<double>& q) {
  const double M = scene.system.M(), N = scene.system.N();
  std::copy_n(q.begin(), scene.system.q.size(), scene.system.q.begin());
  scene.system[Model::kM] = M;
  scene.system[Model::kN] = N;
  std::vector<Placement> placements;
  for (const SimulatedPlacement& simulated : Simulate(scene)) {
    Placement& placement = placements.emplace_back();
    placement.name = simulated.name;
    placement.profiles = Compress(simulated);
  }
  Declaration declaration;
  declaration.search = {{M - 1, N - 1}, {M + 1, N + 1}, 1};
  const auto result = Scanner(declaration, model, placements).Calibrate({});
  EXPECT_TRUE(result.ok()) << result.error().message;
  return result.ok() ? *result : Calibration();
}

inline std::vector<double> NoErrors() { return std::vector<double>(ModelThatConsiders({}).quantities().size(), 0.0); }

inline PointUncertainty PointsOf(const Calibration& calibration) {
  auto points = PointUncertainty::From(calibration);
  EXPECT_TRUE(points.ok()) << points.error().message;
  return *std::move(points);
}

}  // namespace scancal::turntable
