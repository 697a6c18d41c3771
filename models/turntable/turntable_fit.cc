// The joint fit of a turntable.
#include <algorithm>
#include "models/median.h"
#include "models/parts/correlated_noise.h"
#include "models/turntable/smooth_columns.h"
#include "models/turntable/turntable_scanner.h"

namespace scancal {
namespace {

// Line correlation declared as a length: what it adds to the offset and the slope of a profile of the usual size.
void DeclareLineCorrelation(const TurntableDeclaration& declaration, const std::vector<Placement>& placements,
                            Turntable* model) {
  if (!declaration.line_correlation) return;
  const Quantity& noise = model->quantities()[Turntable::kNoiseY];
  const double sigma = noise.role == Role::kConsider ? noise.u : std::max(PureOf(placements).sigma(), kLeastSigma_mm);
  std::vector<double> counts, spreads;
  for (const Placement& placement : placements) {
    for (const Profile& profile : placement.profiles) {
      counts.push_back(profile.count);
      spreads.push_back(profile.factor(1, 1) / profile.factor(0, 0));
    }
  }
  const LineNoise excess = ExcessOfCorrelatedNoise(*declaration.line_correlation, Median(counts), Median(spreads));
  for (const auto& [k, u] : {std::pair{Turntable::kLineOffset, excess.offset}, {Turntable::kLineSlope, excess.slope}}) {
    model->quantity(k).role = Role::kConsider;
    model->quantity(k).u = sigma * u;
  }
}

}  // namespace

std::vector<PlaneStorey> StoreysOf(const std::vector<Placement>& placements, const TurntablePose& tilts) {
  std::vector<PlaneStorey> storeys;
  for (const Placement& placement : placements)
    storeys.emplace_back(Views(placement.profiles, Turntable::Residuals::kPlane), tilts);
  return storeys;
}

TurntableFit TurntableScanner::Fit(const TurntablePose& pose, Turntable::Residuals residuals,
                                   const std::vector<int>& estimate, std::optional<size_t> without,
                                   int max_iterations) const {
  TurntableFit fit;
  std::vector<Placement> placements = placements_;
  if (without) placements.erase(placements.begin() + static_cast<std::ptrdiff_t>(*without));
  const std::vector<PlaneStorey> storeys = StoreysOf(placements, pose);
  double rms = kLeastSigma_mm;
  for (const PlaneStorey& storey : storeys) rms = std::max(rms, storey.Rmse(pose.M, pose.N, PlaneFit::kOrthogonal));
  const double pure = PureOf(placements).sigma();
  fit.sigma = residuals == Turntable::Residuals::kDepth && pure > kLeastSigma_mm ? pure : rms;
  const auto model = std::make_shared<Turntable>(residuals);
  for (int k = 0; k < std::ssize(model_.quantities()); ++k) model->quantity(k) = model_.quantities()[k];
  for (const int k : estimate) model->quantity(k).role = Role::kEstimate;
  DeclareLineCorrelation(declaration_, placements, model.get());
  for (size_t t = 0; t < placements.size(); ++t) {
    Turntable::Target& target = fit.targets.emplace_back();
    target.name = placements[t].name;
    target.views = Views(placements[t].profiles, residuals);
    const auto [normal, distance] = storeys[t].FitPlane(pose.M, pose.N);
    Turntable::SetPlane(normal, distance, &target);
    if (residuals == Turntable::Residuals::kDepth)
      AddForm(placements[t].profiles, pose, normal, distance, &target.views);
  }
  const ScannedVolume volume = VolumeOf(placements);
  for (size_t t = 0; residuals == Turntable::Residuals::kDepth && t < placements.size(); ++t)
    AddBend(volume, placements[t].profiles, &fit.targets[t].views);
  Problem problem = MakeProblem<Turntable>(model, fit.targets);
  problem.WeighEqually(fit.sigma);
  Estimate from = NominalStart(problem);
  Eigen::Index e = 0;
  for (const int k : problem.With({Scope::kSystem}, Role::kEstimate)) {
    if (k == Turntable::kM) from.system[e] = pose.M;
    if (k == Turntable::kN) from.system[e] = pose.N;
    ++e;
  }
  fit.solution = Solve(std::move(problem), from, {max_iterations});
  return fit;
}

TurntableFit TurntableScanner::FitWeighted(const TurntableFit& plain, int max_iterations) const {
  TurntableFit fit = plain;
  fit.solution = SolveWeighted(plain.solution, kLeastSigma_mm, {max_iterations});
  return fit;
}

TurntablePose TurntableFit::Pose() const {
  return TurntablePose::Of(Values(solution.problem, solution.fit.estimate, 0));
}

std::pair<Eigen::Vector3d, double> TurntableFit::Plane(size_t target) const {
  auto [normal, distance] = Turntable::Plane(targets[target], solution.fit.estimate.targets[target]);
  if (distance >= 0) return {normal, distance};
  return {-normal, -distance};
}

}  // namespace scancal
