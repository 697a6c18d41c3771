// Simulated turntable scenes as problems, without files.
#pragma once
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>
#include "models/turntable.h"
#include "models/turntable/compress.h"
#include "models/turntable/simulate.h"
#include "solver/model.h"

namespace scancal::turntable {

struct PoseAsProblem {
  Model::Residuals residuals = Model::Residuals::kDepth;
  bool compressed = true;
  bool reversed = false;
  double scale_y_error = 0;  // the profiler shows y / (1 + this)
};

inline std::vector<Profile> Compress(const SimulatedPlacement& placement) {
  std::vector<Profile> profiles;
  for (const SimulatedProfile& raw : placement.profiles)
    profiles.push_back(CompressProfile(raw.alpha, raw.y, raw.z, {}));
  return profiles;
}

// Targets at the true planes, turned a little so that nothing starts at the solution.
inline std::vector<Model::Target> MakeTargets(std::vector<SimulatedPlacement> placements, const PoseAsProblem& as) {
  std::vector<Model::Target> targets;
  for (SimulatedPlacement& placement : placements) {
    for (SimulatedProfile& profile : placement.profiles) {
      for (double& y : profile.y) y /= 1 + as.scale_y_error;
      if (as.reversed) {
        std::reverse(profile.y.begin(), profile.y.end());
        std::reverse(profile.z.begin(), profile.z.end());
      }
    }
    Model::Target& target = targets.emplace_back();
    target.name = placement.name;
    Model::SetPlane(placement.normal + Eigen::Vector3d(1e-3, -2e-3, 1e-3), placement.distance + 0.3, &target);
    if (as.compressed) {
      target.views = Views(Compress(placement), as.residuals);
    } else {
      for (const SimulatedProfile& profile : placement.profiles) {
        Model::View& view = target.views.emplace_back();
        view.alpha = profile.alpha;
        view.count = static_cast<double>(profile.y.size());
        for (size_t i = 0; i < profile.y.size(); ++i) view.points.push_back({1, profile.y[i], profile.z[i]});
        const Eigen::Map<const Eigen::VectorXd> z(profile.z.data(), std::ssize(profile.z));
        view.line.resize(z.size(), 2);
        view.line << Eigen::VectorXd::Ones(z.size()), z.array() - z.mean();
      }
    }
    if (as.reversed) std::reverse(target.views.begin(), target.views.end());
  }
  if (as.reversed) std::reverse(targets.begin(), targets.end());
  return targets;
}

// M and N start half a millimetre from the truth.
inline Estimate StartNear(const Problem& problem, const System& truth) {
  Estimate start = NominalStart(problem);
  const std::vector<int> system = problem.With({Scope::kSystem}, Role::kEstimate);
  for (size_t k = 0; k < system.size(); ++k) {
    if (system[k] == Model::kM) start.system[static_cast<Eigen::Index>(k)] = truth.M() + 0.5;
    if (system[k] == Model::kN) start.system[static_cast<Eigen::Index>(k)] = truth.N() - 0.5;
  }
  return start;
}

inline Problem MakeProblemOf(const Scene& scene, const PoseAsProblem& as, Model model) {
  return MakeProblem<Model>(std::make_shared<const Model>(std::move(model)), MakeTargets(Simulate(scene), as));
}

}  // namespace scancal::turntable
