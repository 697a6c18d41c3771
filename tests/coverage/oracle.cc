#include "tests/coverage/oracle.h"
#include <glog/logging.h>
#include <Eigen/Geometry>
#include <memory>
#include "models/line/noise.h"
#include "solver/dense.h"
#include "solver/uncertainty/covariance.h"
#include "solver/weigh.h"

namespace scancal::coverage {

using namespace turntable;
namespace {

void Set(Model::Index index, Role role, double u, Model* model) {
  model->quantity(index).role = u > 0 ? role : Role::kHold;
  model->quantity(index).u = u;
}

Model TrueModel(const Scene& scene, double spread) {
  Model model(Model::Residuals::kDepth);
  model.quantity(Model::kM).value = scene.system.M();
  model.quantity(Model::kN).value = scene.system.N();
  const LineNoise excess = ExcessOfCorrelatedNoise(scene.line_correlation, scene.points, spread);
  Set(Model::kNoiseY, Role::kConsider, scene.noise_y, &model);
  Set(Model::kLineOffset, Role::kConsider, scene.noise_y * excess.offset, &model);
  Set(Model::kLineSlope, Role::kConsider, scene.noise_y * excess.slope, &model);
  Set(Model::kEncoderJitter, Role::kConsider, scene.encoder_jitter, &model);
  for (int k = 0; k < kFormModes; ++k)
    Set(static_cast<Model::Index>(Model::kForm + k), Role::kEstimate, scene.form, &model);
  return model;
}

}  // namespace

Oracle::Oracle(const Scene& scene) : scene_(scene) {
  Scene exact = scene;
  exact.noise_y = exact.encoder_jitter = exact.form = exact.outliers = exact.missing = 0;
  for (const SimulatedPlacement& placement : Simulate(exact)) {
    Plate& plate = plates_.emplace_back();
    plate.normal = placement.normal;
    plate.distance = placement.distance;
    plate.bends = BendsOf(plate, placement.profiles);
  }
}

std::vector<Oracle::Bend> Oracle::BendsOf(const Plate& plate, const std::vector<SimulatedProfile>& profiles) const {
  const Eigen::Vector3d across = plate.normal.cross(Eigen::Vector3d::UnitZ()).normalized(),
                        up = across.cross(plate.normal);
  const auto at = [&](const SimulatedProfile& profile, size_t i) {
    const Eigen::Vector3d p = scene_.system.Point(profile.alpha, profile.y[i], profile.z[i]);
    return Eigen::Vector2d(across.dot(p), up.dot(p));
  };
  Eigen::AlignedBox2d seen;
  for (const SimulatedProfile& profile : profiles)
    for (size_t i = 0; i < profile.y.size(); ++i) seen.extend(at(profile, i));
  std::vector<Bend> bends;
  for (const SimulatedProfile& profile : profiles) {
    const auto n = std::ssize(profile.y);
    Eigen::MatrixXd line(n, 2), modes(n, kFormModes);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto k = static_cast<size_t>(i);
      const Eigen::Array2d scaled = (at(profile, k) - seen.center()).array() / (seen.sizes() / 2).array();
      line.row(i) << 1, profile.z[k];
      modes.row(i) = Eigen::Map<const Eigen::RowVectorXd>(
          FormModesAt(scaled[0], scaled[1], seen.sizes()[0] / seen.sizes()[1]).data(), kFormModes);
    }
    const Eigen::MatrixXd fitted = LeastSquares(line, modes);
    bends.push_back({fitted.row(0), fitted.row(1)});
  }
  return bends;
}

Guess Oracle::Ask(const std::vector<Placement>& seen) const {
  std::vector<Model::Target> targets;
  for (size_t t = 0; t < seen.size(); ++t) {
    CHECK_EQ(seen[t].profiles.size(), plates_[t].bends.size()) << "a whole profile was set aside";
    Model::Target& target = targets.emplace_back();
    target.name = seen[t].name;
    target.views = Views(seen[t].profiles, Model::Residuals::kDepth);
    Model::SetPlane(plates_[t].normal, plates_[t].distance, &target);
    for (size_t v = 0; v < target.views.size(); ++v) {
      Model::View& view = target.views[v];
      const Bend& bend = plates_[t].bends[v];
      view.form.resize(std::ssize(view.points), kFormModes);
      for (Eigen::Index i = 0; i < view.form.rows(); ++i)
        view.form.row(i) = view.points[i].weight * (bend.offset + view.points[i].z * bend.slope);
    }
  }
  const ProfileFactor& usual = seen[0].profiles[0].factor;
  Problem problem = MakeProblem<Model>(std::make_shared<const Model>(TrueModel(scene_, usual(1, 1) / usual(0, 0))),
                                       std::move(targets));
  const Estimate at_truth = NominalStart(problem);
  Weigh(&problem, at_truth);
  const Linearization linear = Linearize(problem, at_truth, Storey::kViews);
  return {InverseInformation(linear).diagonal().cwiseSqrt(), GaussNewtonStep(linear).system};
}

}  // namespace scancal::coverage
