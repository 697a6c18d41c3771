// Noise along the laser line moves where points were measured, and must not look like a form of the plate.
#include <gtest/gtest.h>
#include "io/units.h"
#include "models/turntable/compress.h"
#include "models/turntable/scanner.h"
#include "models/turntable/simulate.h"
#include "solver/random.h"

namespace scancal::turntable {
namespace {

std::vector<RawScan> ScansWithNoiseZ(const Scene& scene, double noise_z) {
  Random random(scene.seed, 1000);
  std::vector<RawScan> scans;
  for (const SimulatedPlacement& placement : Simulate(scene)) {
    RawScan& scan = scans.emplace_back();
    scan.name = placement.name;
    for (const SimulatedProfile& from : placement.profiles) {
      RawProfile profile{static_cast<double>(scan.profiles.size()), from.alpha, from.y, from.z, {}};
      for (double& z : profile.z) z += noise_z * random.Normal();
      scan.profiles.push_back(std::move(profile));
    }
    Clean(&scan);
  }
  return scans;
}

TEST(NoiseAlongTheLine, IsNoForm) {
  Scene scene;
  scene.points = 100;
  scene.encoder_jitter = 0.002 * kDegree;
  Declaration declaration;
  declaration.search = SearchAround(scene.system, 20, 30);
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    scene.seed = seed;
    const auto scanner = Compress(declaration, Model(Model::Residuals::kDepth), ScansWithNoiseZ(scene, 0.1));
    ASSERT_TRUE(scanner.ok()) << scanner.error().message;
    const Result<Calibration> result = (*scanner)->Calibrate({});
    ASSERT_TRUE(result.ok()) << result.error().message;
    EXPECT_TRUE(result->ok()) << result->unreliable.front();
    for (const MisfitTest& misfit : result->misfits) EXPECT_GT(misfit.p, 1e-3) << misfit.source << " " << misfit.F;
  }
}

}  // namespace
}  // namespace scancal::turntable
