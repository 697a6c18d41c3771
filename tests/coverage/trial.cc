#include "tests/coverage/trial.h"
#include <cmath>
#include <limits>
#include "models/turntable/scanner.h"
#include "solver/parallel.h"
#include "solver/uncertainty/gum.h"

namespace scancal::coverage {

using namespace turntable;
namespace {

std::vector<RawScan> CleanScans(const std::vector<SimulatedPlacement>& placements) {
  std::vector<RawScan> scans;
  for (const SimulatedPlacement& placement : placements) {
    RawScan& scan = scans.emplace_back();
    scan.name = placement.name;
    for (const SimulatedProfile& from : placement.profiles) {
      const auto number = static_cast<double>(scan.profiles.size());
      RawProfile profile{number, from.alpha, {}, {}, {}, number};
      for (size_t i = 0; i < from.y.size(); ++i) {
        if (std::isnan(from.y[i])) continue;
        profile.y.push_back(from.y[i]);
        profile.z.push_back(from.z[i]);
      }
      scan.missing += static_cast<double>(from.y.size() - profile.y.size());
      if (!profile.y.empty()) scan.profiles.push_back(std::move(profile));
    }
    Clean(&scan);
  }
  return scans;
}

Model Declared(const Row& row) {
  Model model(Model::Residuals::kDepth);
  for (int k = 0; k < kFormModes && row.declared_form > 0; ++k) {
    model.quantity(Model::kForm + k).role = Role::kConsider;
    model.quantity(Model::kForm + k).u = row.declared_form;
  }
  if (row.declare) row.declare(&model);
  return model;
}

}  // namespace

Trial Try(const Row& row, const Oracle& oracle, uint64_t seed) {
  static const double k = CoverageFactor(kCoverage, std::numeric_limits<double>::infinity());
  Scene scene = row.scene;
  scene.seed = seed;
  Random random(seed, uint64_t{1} << 40);
  if (row.draw) row.draw(&random, &scene);
  const std::vector<SimulatedPlacement> placements = Simulate(scene);
  Declaration declaration;
  declaration.search = scene.search;
  declaration.drift_declared = row.begins_anew;
  Trial trial;
  const auto scanner = Compress(declaration, Declared(row), CleanScans(placements));
  if (!scanner.ok()) {
    trial.unreliable.push_back(scanner.error().message);
    return trial;
  }
  trial.oracle = oracle.Ask((*scanner)->placements());
  const Result<Calibration> result = (*scanner)->Calibrate({});
  if (!result.ok()) {
    trial.unreliable.push_back(result.error().message);
    return trial;
  }
  const Parameter &M = *result->Find("M"), &N = *result->Find("N");
  trial.error = {M.value - scene.system.M(), N.value - scene.system.N()};
  trial.U = {M.U, N.U};
  trial.U_naive = k * Eigen::Vector2d(M.u_naive, N.u_naive);
  trial.U_clustered = k * Eigen::Vector2d(M.u_clustered, N.u_clustered);
  trial.unreliable.assign(result->unreliable.begin(), result->unreliable.end());
  trial.warnings.assign(result->warnings.begin(), result->warnings.end());
  return trial;
}

std::vector<Trial> TryAll(const Row& row, size_t number, size_t sets, int threads, const std::function<void()>& done) {
  const Oracle oracle(row.scene);
  std::vector<Trial> trials(sets);
  InParallel(sets, threads, [&](size_t set) {
    trials[set] = Try(row, oracle, (static_cast<uint64_t>(number) << 32) + set);
    if (done) done();
  });
  return trials;
}

}  // namespace scancal::coverage
