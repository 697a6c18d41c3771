// A robot's model that is told how a scene was made.
#pragma once
#include "models/robot_ball/simulate.h"

namespace scancal::robot_study {

enum class Noise { kDeclared, kEstimated };  // of balls and of the flange

// Default roles of the links; noise as said, the artifact considered with its u.
inline robot_ball::Model DeclaredModel(const robot_ball::Measurements& data, const robot_ball::Scene& scene,
                                       Noise noise = Noise::kDeclared) {
  robot_ball::Model model(data.links, data.spheres);
  const auto consider = [&](int k, double u) {
    if (u > 0) {
      model.quantity(k).role = Role::kConsider;
      model.quantity(k).u = u;
    }
  };
  for (int k = 0; k < static_cast<int>(model.quantities().size()); ++k) {
    const std::string& source = model.quantities()[k].source;
    if (source == "artifact") consider(k, scene.u_spheres);
    if (noise == Noise::kEstimated) continue;
    if (source == "ball") consider(k, scene.ball_noise);
    if (source == "repeatability") consider(k, scene.repeatability);
    if (source == "repeatability_rotation") {
      model.quantity(k).role = Role::kHold;
      consider(k, scene.repeatability_rotation);
    }
  }
  return model;
}

}  // namespace scancal::robot_study
