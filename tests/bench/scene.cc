#include "tests/bench/scene.h"
#include <memory>
#include "solver/grid_search.h"
#include "solver/model.h"

namespace scancal::bench {

turntable::Scene LargeScene() {
  turntable::Scene scene;
  scene.system[turntable::Model::kM] = 123.4;
  scene.system[turntable::Model::kN] = 408.7;
  scene.profiles = scene.points = 1000;
  scene.noise_y = 0.05;
  scene.seed = 1;
  return scene;
}

std::vector<Placement> Compress(const std::vector<SimulatedPlacement>& points) {
  std::vector<Placement> placements;
  for (const SimulatedPlacement& from : points) {
    Placement& placement = placements.emplace_back();
    placement.name = from.name;
    placement.profiles.reserve(from.profiles.size());
    for (const SimulatedProfile& profile : from.profiles)
      placement.profiles.push_back(turntable::CompressProfile(profile.alpha, profile.y, profile.z, {}));
  }
  return placements;
}

std::vector<PlaneStorey> Storeys(const std::vector<Placement>& placements) {
  std::vector<PlaneStorey> storeys;
  for (const Placement& placement : placements) storeys.emplace_back(placement.profiles, turntable::System{});
  return storeys;
}

Start SearchStart(const std::vector<Placement>& placements) {
  const std::vector<PlaneStorey> storeys = Storeys(placements);
  const GridResult grid = GridSearch({{110, 395}, {130, 425}, 1}, static_cast<int>(storeys.size()),
                                     [&](const std::array<double, 2>& at, std::span<double> rmse) {
                                       for (size_t t = 0; t < rmse.size(); ++t)
                                         rmse[t] = storeys[t].Rmse(at[0], at[1], turntable::PlaneFit::kOrthogonal);
                                     });
  Start start{grid.best.at[0], grid.best.at[1], {}};
  for (size_t t = 0; t < storeys.size(); ++t) {
    turntable::Model::Target& plane = start.planes.emplace_back();
    plane.name = placements[t].name;
    const auto [normal, distance] = storeys[t].FitPlane(start.M, start.N);
    turntable::Model::SetPlane(normal, distance, &plane);
  }
  return start;
}

Problem BuildProblem(const std::vector<Placement>& placements, const Start& start,
                     turntable::Model::Residuals residuals) {
  const auto model = std::make_shared<turntable::Model>(residuals);
  std::vector<turntable::Model::Target> targets = start.planes;
  for (size_t t = 0; t < targets.size(); ++t) targets[t].views = turntable::Views(placements[t].profiles, residuals);
  return MakeProblem<turntable::Model>(model, std::move(targets));
}

Estimate StartOf(const Problem& problem, const Start& start) {
  Estimate from = NominalStart(problem);
  from.system << start.M, start.N;
  return from;
}

}  // namespace scancal::bench
