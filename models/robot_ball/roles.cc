// Roles of a robot's quantities, as `parameters:` and `influences:` say.
#include <fmt/format.h>
#include "io/message.h"
#include "models/robot_ball/declaration.h"

namespace scancal {
namespace {

const std::vector<std::string> kInfluences = {"artifact", "ball", "repeatability"};

class Setter {
 public:
  Setter(const RobotDeclaration& declaration, RobotBall* model)
      : declaration_(declaration), dataset_(declaration.dataset), model_(*model) {}

  Result<void> Run() {
    SetLinks();
    for (const ParameterSetting& setting : dataset_.parameters) {
      if (setting.name != "links") SCANCAL_RETURN_IF_ERROR(SetParameter(setting));
      if (setting.name == "links" && declaration_.data.links.empty()) return Unlinked("parameters: links: ");
    }
    SetDeclaredNoise();
    SetSpheres(Role::kConsider);
    for (const InfluenceSetting& setting : dataset_.influences) SCANCAL_RETURN_IF_ERROR(SetInfluence(setting));
    return {};
  }

 private:
  Error Wrong(const std::string& sentence) const { return {dataset_.file.string() + ": " + sentence}; }
  Error Unlinked(const std::string& place) const {
    return Wrong(place +
                 "the poses are those of the flange, expected robot: links and joint angles for a kinematics "
                 "to be estimated");
  }

  // Those that are estimated by default get a prior.
  void SetLinks() {
    for (int k = RobotBall::kLinks; k < model_.FirstOfSpheres(); ++k) {
      Quantity& quantity = model_.quantity(k);
      if (declaration_.links.hold) quantity.role = Role::kHold;
      if (quantity.role == Role::kEstimate)
        quantity.u = quantity.unit == Unit::kMm ? declaration_.links.u_length : declaration_.links.u_angle;
    }
  }

  Result<void> SetParameter(const ParameterSetting& setting) {
    const std::string place = "parameters: " + setting.name + ": ";
    const int index = Find(model_.quantities(), setting.name);
    const bool known = index >= 0 && index < model_.FirstOfSpheres();
    if (!known && declaration_.data.links.empty() && IsLinkName(setting.name)) return Unlinked(place);
    if (!known || model_.quantities()[static_cast<size_t>(index)].scope != Scope::kSystem)
      return Wrong(place + "unknown parameter" + Suggestion(setting.name, ParameterNames()));
    Quantity& quantity = model_.quantity(index);
    const double unit = dataset_.units.Of(quantity.unit == Unit::kMm ? Dimension::kLength : Dimension::kAngle);
    quantity.role = setting.role == "estimate"   ? Role::kEstimate
                    : setting.role == "consider" ? Role::kConsider
                                                 : Role::kHold;
    quantity.value = setting.value.value_or(0) * unit;
    quantity.u = setting.u * unit;
    if (index < RobotBall::kArtifact && quantity.role != Role::kEstimate && !setting.value)
      return Wrong(place + setting.role + ": expected its value, for example {" + setting.role + ": 123}");
    return {};
  }

  static bool IsLinkName(const std::string& name) {
    Quantities links;
    DeclareLinks(20, &links);
    return Find(links, name) >= 0;
  }

  std::vector<std::string> ParameterNames() const {
    std::vector<std::string> names = {"links"};
    for (int k = 0; k < model_.FirstOfSpheres(); ++k)
      if (const Quantity& quantity = model_.quantities()[static_cast<size_t>(k)]; quantity.scope == Scope::kSystem)
        names.push_back(quantity.name);
    return names;
  }

  Result<void> SetInfluence(const InfluenceSetting& setting) {
    const std::string place = "influences: " + setting.name + ": ";
    if (setting.role == "yes" || setting.role == "no")
      return Wrong(place + "found " + setting.role + ", expected a standard uncertainty");
    if (setting.name == "artifact") return SetArtifact(setting, place);
    if (setting.name != "ball" && setting.name != "repeatability")
      return Wrong(place + "unknown influence" + Suggestion(setting.name, kInfluences));
    const double u = setting.u * dataset_.units.length_in_mm;
    if (setting.role == "estimate" && u > 0)
      return Wrong(place + "its variance is estimated without a prior, expected estimate or a number");
    const bool ball = setting.name == "ball";
    if (ball && setting.role != "estimate" && u == 0)
      return Wrong(place + "expected more than 0, or estimate: every ball has noise");
    const Role role = setting.role == "estimate" ? Role::kEstimate : u > 0 ? Role::kConsider : Role::kHold;
    SetThree(ball ? RobotBall::kBall : RobotBall::kRepeatability, role, u);
    return {};
  }

  void SetThree(int first, Role role, double u) {
    for (int k = first; k < first + 3; ++k) {
      model_.quantity(k).role = role;
      model_.quantity(k).u = u;
    }
  }

  // Uncertainties in the table of the balls stand for an influence that is not declared.
  void SetDeclaredNoise() {
    if (declaration_.centres_have_u) SetThree(RobotBall::kBall, Role::kConsider, declaration_.data.usual_ball_noise);
  }

  void SetSpheres(Role role) {
    for (size_t k = 0; k < declaration_.u_of_spheres.size(); ++k) {
      const double u = declaration_.u_of_spheres[k];
      SetThree(model_.FirstOfSpheres() + 3 * static_cast<int>(k), u > 0 ? role : Role::kHold, u);
    }
  }

  Result<void> SetArtifact(const InfluenceSetting& setting, const std::string& place) {
    if (setting.role == "estimate" && declaration_.data.u_spheres == 0)
      return Wrong(place +
                   "expected {estimate: 0, u: ...} or a column u in the table of the artifact: without a prior "
                   "its centres are not determined");
    SetSpheres(setting.role == "estimate"   ? Role::kEstimate
               : setting.role == "consider" ? Role::kConsider
                                            : Role::kHold);
    return {};
  }

  const RobotDeclaration& declaration_;
  const Dataset& dataset_;
  RobotBall& model_;
};

}  // namespace

Result<RobotBall> DeclareModel(const RobotDeclaration& declaration) {
  RobotBall model(declaration.data.links, declaration.data.spheres);
  SCANCAL_RETURN_IF_ERROR(Setter(declaration, &model).Run());
  return model;
}

}  // namespace scancal
