#include "tests/coverage/oracle.h"
#include <memory>
#include "models/parts/correlated_noise.h"
#include "solver/uncertainty/covariance.h"
#include "solver/weigh.h"

namespace scancal::coverage {
namespace {

void Consider(Turntable::Index index, double u, Turntable* model) {
  model->quantity(index).role = u > 0 ? Role::kConsider : Role::kHold;
  model->quantity(index).u = u;
}

Turntable TrueModel(const TurntableScene& scene, const Profile& usual) {
  Turntable model(Turntable::Residuals::kDepth);
  model.quantity(Turntable::kM).value = scene.pose.M;
  model.quantity(Turntable::kN).value = scene.pose.N;
  const LineNoise excess =
      ExcessOfCorrelatedNoise(scene.line_correlation, scene.points, usual.factor(1, 1) / usual.factor(0, 0));
  Consider(Turntable::kNoiseY, scene.noise_y, &model);
  Consider(Turntable::kLineOffset, scene.noise_y * excess.offset, &model);
  Consider(Turntable::kLineSlope, scene.noise_y * excess.slope, &model);
  Consider(Turntable::kEncoderJitter, scene.encoder_jitter, &model);
  return model;
}

}  // namespace

Oracle AskOracle(const TurntableScene& scene, const std::vector<SimulatedPlacement>& truth,
                 const std::vector<Placement>& seen) {
  std::vector<Turntable::Target> targets;
  for (size_t t = 0; t < seen.size(); ++t) {
    Turntable::Target& target = targets.emplace_back();
    target.name = seen[t].name;
    target.views = Views(seen[t].profiles, Turntable::Residuals::kDepth);
    Turntable::SetPlane(truth[t].normal, truth[t].distance, &target);
  }
  Problem problem = MakeProblem<Turntable>(
      std::make_shared<const Turntable>(TrueModel(scene, seen[0].profiles[0])), std::move(targets));
  const Estimate at_truth = NominalStart(problem);
  Weigh(&problem, at_truth);
  const Linearization linear = Linearize(problem, at_truth, Storey::kViews);
  return {InverseInformation(linear).diagonal().cwiseSqrt(), GaussNewtonStep(linear).system};
}

}  // namespace scancal::coverage
