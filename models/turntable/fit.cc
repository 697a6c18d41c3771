// The joint fit of a turntable.
#include <algorithm>
#include "models/line/noise.h"
#include "models/median.h"
#include "models/turntable/scanner.h"

namespace scancal::turntable {
namespace {

// Line correlation declared as a length: what it adds to the offset and the slope of a profile of the usual size.
void DeclareLineCorrelation(const Declaration& declaration, const std::vector<Placement>& placements, Model* model) {
  if (!declaration.line_correlation) return;
  const Quantity& noise = model->quantities()[Model::kNoiseY];
  const double sigma = noise.role == Role::kConsider ? noise.u : std::max(PureOf(placements).sigma(), kLeastSigma_mm);
  std::vector<double> counts, spreads;
  for (const Placement& placement : placements) {
    for (const Profile& profile : placement.profiles) {
      counts.push_back(profile.count);
      spreads.push_back(profile.factor(1, 1) / profile.factor(0, 0));
    }
  }
  const LineNoise excess = ExcessOfCorrelatedNoise(*declaration.line_correlation, Median(counts), Median(spreads));
  for (const auto& [k, u] : {std::pair{Model::kLineOffset, excess.offset}, {Model::kLineSlope, excess.slope}}) {
    model->quantity(k).role = Role::kConsider;
    model->quantity(k).u = sigma * u;
  }
}

// To the estimate.
bool Matters(const Quantity& quantity) { return quantity.role == Role::kEstimate || quantity.value != 0; }

}  // namespace

JointFit Scanner::Fit(const System& system, Model::Residuals residuals, const FitChoice& choice) const {
  JointFit fit;
  std::vector<Placement> placements = placements_;
  if (choice.without) placements.erase(placements.begin() + static_cast<std::ptrdiff_t>(*choice.without));
  fit.depths = system.depths;
  const std::vector<PlaneStorey> storeys = StoreysOf(placements, system);
  double rms = kLeastSigma_mm;
  for (const PlaneStorey& storey : storeys)
    rms = std::max(rms, storey.Rmse(system.M(), system.N(), PlaneFit::kOrthogonal));
  const double pure = PureOf(placements).sigma();
  fit.sigma = residuals == Model::Residuals::kDepth && pure > kLeastSigma_mm ? pure : rms;
  const auto model = std::make_shared<Model>(residuals);
  for (int k = 0; k < std::ssize(model_.quantities()); ++k) model->quantity(k) = model_.quantities()[k];
  for (const int k : choice.estimate) model->quantity(k).role = Role::kEstimate;
  DeclareLineCorrelation(declaration_, placements, model.get());
  for (size_t t = 0; t < placements.size(); ++t) {
    Model::Target& target = fit.targets.emplace_back();
    target.name = placements[t].name;
    target.views = Views(placements[t].profiles, residuals);
    const auto [normal, distance] = storeys[t].FitPlane(system.M(), system.N());
    Model::SetPlane(normal, distance, &target);
    const bool all = choice.influences && residuals == Model::Residuals::kDepth;
    if (all || Matters(model->quantities()[Model::kForm]))
      AddForm(placements[t].profiles, system, normal, distance, &target.views);
    if (all || Matters(model->quantities()[Model::kLinearity])) AddBend(system, placements[t].profiles, &target.views);
  }
  Problem problem = MakeProblem<Model>(model, fit.targets);
  problem.WeighEqually(fit.sigma);
  Estimate from = NominalStart(problem);
  std::vector<double> values = Values(problem, from, 0);
  std::copy(system.q.begin(), system.q.end(), values.begin());
  SetValues(problem, values, 0, &from);
  fit.solution = Solve(std::move(problem), from, {choice.max_iterations});
  return fit;
}

JointFit Scanner::FitWeighted(const JointFit& plain, int max_iterations) const {
  JointFit fit = plain;
  fit.solution = SolveWeighted(plain.solution, kLeastSigma_mm, {max_iterations});
  return fit;
}

System JointFit::Found() const {
  const std::vector<double> values = Values(solution.problem, solution.fit.estimate, 0);
  System found{{}, depths};
  std::copy_n(values.begin(), found.q.size(), found.q.begin());
  return found;
}

std::pair<Eigen::Vector3d, double> JointFit::Plane(size_t target) const {
  auto [normal, distance] = Model::Plane(targets[target], solution.fit.estimate.targets[target]);
  if (distance >= 0) return {normal, distance};
  return {-normal, -distance};
}

}  // namespace scancal::turntable
