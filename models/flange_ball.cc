#include "models/flange_ball.h"

namespace scancal::flange_ball {

Model::Model(std::vector<Link> links)
    : links_(std::move(links)), joints_of_terms_(JointsOfTerms(static_cast<int>(links_.size()))) {
  using enum Scope;
  const auto declare = [&](const std::string& name, const std::vector<const char*>& components, Unit unit, Scope scope,
                           Role role, const char* source = "") {
    for (const char* component : components)
      quantities_.push_back({name + component, unit, scope, role, 0, 0, false, source});
  };
  declare("ball", {"_x", "_y", "_z"}, Unit::kMm, kSystem, Role::kEstimate);
  declare("spacing", {""}, Unit::kMm, kSystem, Role::kHold);
  declare("socket", {"_x", "_y", "_z"}, Unit::kMm, kTarget, Role::kEstimate);
  declare("direction", {"_1", "_2"}, Unit::kRad, kTarget, Role::kEstimate);
  declare("seat", {"_x", "_y", "_z"}, Unit::kMm, kPoint, Role::kEstimate, "seat");  // `estimate` means their variance
  DeclareLinks(links_.size(), &quantities_);
  SetDefaultLinkRoles(links_, kLinks, &quantities_);
  for (size_t k = 1; k <= links_.size(); ++k)
    declare("joint_", {std::to_string(k).c_str()}, Unit::kRad, kView, Role::kHold, "joints");
  DeclareJointTerms(links_.size(), &quantities_);
}

void Model::SetDirection(const Eigen::Vector3d& direction, Target* target) {
  target->direction = direction.normalized();
  target->across[0] = target->direction.unitOrthogonal();
  target->across[1] = target->direction.cross(target->across[0]);
}

}  // namespace scancal::flange_ball
