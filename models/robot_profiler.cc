#include "models/robot_profiler.h"

namespace scancal::robot_profiler {

Model::Model(std::vector<Link> links, Residuals residuals)
    : links_(std::move(links)),
      joints_of_terms_(JointsOfTerms(static_cast<int>(links_.size()))),
      residuals_(residuals) {
  using enum Scope;
  const auto declare = [&](const std::string& name, const std::vector<const char*>& components, Unit unit, Scope scope,
                           Role role, const char* source = "") {
    for (const char* component : components)
      quantities_.push_back({name + component, unit, scope, role, 0, 0, false, source});
  };
  const std::vector<const char*> lengths = {"_x", "_y", "_z"}, turns = {"_rx", "_ry", "_rz"};
  declare("hand_eye", lengths, Unit::kMm, kSystem, Role::kEstimate);
  declare("hand_eye", turns, Unit::kRad, kSystem, Role::kEstimate);
  declare("scale", {"_y", "_z"}, Unit::kOne, kSystem, Role::kHold);
  declare("normal", {"_1", "_2"}, Unit::kRad, kTarget, Role::kEstimate);
  declare("distance", {""}, Unit::kMm, kTarget, Role::kEstimate);
  declare("repeatability", lengths, Unit::kMm, kView, Role::kEstimate, "repeatability");  // of these, their variance
  declare("repeatability", turns, Unit::kRad, kView, Role::kEstimate, "repeatability_rotation");
  declare("noise", {"_y"}, Unit::kMm, kPoint, Role::kEstimate, "noise_y");
  DeclareLinks(links_.size(), &quantities_);
  SetDefaultLinkRoles(links_, kLinks, &quantities_);
  DeclareJointTerms(links_.size(), &quantities_);
}

Model Model::As(Residuals residuals) const {
  Model model = *this;
  model.residuals_ = residuals;
  return model;
}

void Model::Target::SetPlane(const Eigen::Vector3d& unit_normal, double d) {
  normal = unit_normal;
  distance = d;
  e1 = normal.unitOrthogonal();
  e2 = normal.cross(e1);
}

}  // namespace scancal::robot_profiler
