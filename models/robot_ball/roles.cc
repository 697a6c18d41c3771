// Roles of a robot's quantities, as `parameters:` and `influences:` say.
#include <span>
#include "io/message.h"
#include "models/parts/declared_parameter.h"
#include "models/robot_ball/declaration.h"

namespace scancal {
namespace {

const std::vector<std::string> kInfluences = {"artifact", "ball", "repeatability"};

class Setter {
 public:
  Setter(const RobotDeclaration& declaration, RobotBall* model)
      : declaration_(declaration), dataset_(declaration.dataset), model_(*model) {}

  Result<void> Run() {
    const std::span<Quantity> quantities(&model_.quantity(0), model_.FirstOfSpheres());
    SetLinks(declaration_.links, quantities.subspan(RobotBall::kLinks));
    for (const ParameterSetting& setting : dataset_.parameters) {
      if (model_.links().empty() && IsLinkName(setting.name))
        return InFile(dataset_, "parameters: " + setting.name +
                                    ": the poses are those of the flange, expected robot: links and joint angles for a "
                                    "kinematics to be estimated");
      if (setting.name != "links")
        SCANCAL_RETURN_IF_ERROR(SetDeclared(setting, dataset_, {"links"}, RobotBall::kArtifact, quantities));
    }
    SetDeclaredNoise();
    SetSpheres(Role::kConsider);
    for (const InfluenceSetting& setting : dataset_.influences) SCANCAL_RETURN_IF_ERROR(SetInfluence(setting));
    return {};
  }

 private:
  static bool IsLinkName(const std::string& name) {
    Quantities links;
    DeclareLinks(20, &links);
    return name == "links" || Find(links, name) >= 0;
  }

  Result<void> SetInfluence(const InfluenceSetting& setting) {
    const std::string place = "influences: " + setting.name + ": ";
    if (setting.role == "yes" || setting.role == "no")
      return InFile(dataset_, place + "found " + setting.role + ", expected a standard uncertainty");
    if (setting.name == "artifact") return SetArtifact(setting, place);
    if (setting.name != "ball" && setting.name != "repeatability")
      return InFile(dataset_, place + "unknown influence" + Suggestion(setting.name, kInfluences));
    const double u = setting.u * dataset_.units.length_in_mm;
    if (setting.role == "estimate" && u > 0)
      return InFile(dataset_, place + "its variance is estimated without a prior, expected estimate or a number");
    const bool ball = setting.name == "ball";
    if (ball && setting.role != "estimate" && u == 0)
      return InFile(dataset_, place + "expected more than 0, or estimate: every ball has noise");
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
      return InFile(dataset_,
                    place +
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
