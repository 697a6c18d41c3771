// A robot's model that is told how a scene was made.
#pragma once
#include <string>
#include <utility>
#include <vector>
#include "models/robot_ball/simulate.h"

namespace scancal::robot_study {

enum class Noise { kDeclared, kEstimated };  // of balls and of the flange

// What a robot may do besides: its poses turn by 0.2 mrad; the second and third joint sag under the arm; every joint
// has a backlash of 0.2 mrad to either side.
inline robot_ball::Scene WithRotation(robot_ball::Scene scene) {
  scene.repeatability_rotation = 2e-4;
  return scene;
}
inline robot_ball::Scene WithTerms(robot_ball::Scene scene, const std::vector<std::pair<std::string, double>>& values) {
  Quantities terms;
  DeclareJointTerms(scene.links.size(), &terms);
  scene.joint_terms.resize(terms.size());
  for (const auto& [name, value] : values) scene.joint_terms[static_cast<size_t>(Find(terms, name))] = value;
  return scene;
}
inline robot_ball::Scene WithGravity(const robot_ball::Scene& scene) {
  return WithTerms(scene, {{"gravity_2_2", 6e-4}, {"gravity_2_4", 9e-4}, {"gravity_3_4", 5e-4}});
}
inline robot_ball::Scene WithBacklash(const robot_ball::Scene& scene) {
  std::vector<std::pair<std::string, double>> values;
  for (size_t joint = 1; joint <= scene.links.size(); ++joint)
    values.emplace_back("backlash_" + std::to_string(joint), 2e-4);
  return WithTerms(scene, values);
}

// Default roles of the links; what the scene's joints do is estimated; noise as said, the artifact considered with its
// u.
inline robot_ball::Model DeclaredModel(const robot_ball::Measurements& data, const robot_ball::Scene& scene,
                                       Noise noise = Noise::kDeclared) {
  robot_ball::Model model(data.links, data.spheres, data.measured_in_world);
  const auto consider = [&](int k, double u) {
    if (u > 0) {
      model.quantity(k).role = Role::kConsider;
      model.quantity(k).u = u;
    }
  };
  for (size_t k = 0; k < scene.joint_terms.size(); ++k)
    if (scene.joint_terms[k] != 0)
      model.quantity(model.FirstOfJointTerms() + static_cast<int>(k)).role = Role::kEstimate;
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
