#include "models/turntable/influences.h"
#include <algorithm>
#include <map>
#include "io/message.h"
#include "models/scanner.h"

namespace scancal {
namespace {

// Median peak to valley of a surface of such modes over its rms (docs/uncertainty.md, section 2: 6.3).
constexpr double kPeakToValley = 6;

// Those with a quantity of the same name and no rule of their own.
const std::map<std::string, Turntable::Index> kQuantities = {{"noise_y", Turntable::kNoiseY},
                                                             {"noise_z", Turntable::kNoiseZ},
                                                             {"encoder_jitter", Turntable::kEncoderJitter},
                                                             {"encoder_cos1", Turntable::kEncoderCos1},
                                                             {"encoder_sin1", Turntable::kEncoderSin1},
                                                             {"encoder_cos2", Turntable::kEncoderCos2},
                                                             {"encoder_sin2", Turntable::kEncoderSin2},
                                                             {"scale_y", Turntable::kScaleY},
                                                             {"scale_z", Turntable::kScaleZ},
                                                             {"shear", Turntable::kShear},
                                                             {"linearity", Turntable::kLinearity}};
const std::vector<std::string> kOthers = {"line_correlation", "form",        "flatness",
                                          "one_plate",        "temperature", "expansion"};

std::vector<std::string> Names() {
  std::vector<std::string> names = kOthers;
  for (const auto& [name, index] : kQuantities) names.push_back(name);
  std::sort(names.begin(), names.end());
  return names;
}

class Setter {
 public:
  Setter(const Dataset& dataset, Turntable* model, TurntableDeclaration* declaration)
      : dataset_(dataset), model_(*model), declaration_(*declaration) {}

  Result<void> Run() {
    for (const InfluenceSetting& setting : dataset_.influences) SCANCAL_RETURN_IF_ERROR(Set(setting));
    return SetExpansion();
  }

 private:
  Error Wrong(const std::string& influence, const std::string& sentence) const {
    return InFile(dataset_, "influences: " + influence + ": " + sentence);
  }

  Result<void> Set(const InfluenceSetting& setting) {
    if (setting.name == "one_plate") return SetOnePlate(setting);
    if (setting.role == "yes" || setting.role == "no")
      return Wrong(setting.name, "found " + setting.role + ", expected a standard uncertainty");
    if (setting.name == "line_correlation") return SetLineCorrelation(setting);
    if (setting.name == "form" || setting.name == "flatness") return SetForm(setting);
    if (setting.name == "temperature" || setting.name == "expansion") return KeepForExpansion(setting);
    const auto found = kQuantities.find(setting.name);
    if (found == kQuantities.end()) return Wrong(setting.name, "unknown influence" + Suggestion(setting.name, Names()));
    return SetQuantity(setting, found->second);
  }

  Result<void> SetQuantity(const InfluenceSetting& setting, Turntable::Index index) {
    Quantity& quantity = model_.quantity(index);
    const bool random = quantity.scope == Scope::kView || quantity.scope == Scope::kPoint;
    if (!random && quantity.role != Role::kHold)
      return Wrong(setting.name, "declared twice, here and under parameters");
    if (!random && setting.role == "estimate" && setting.u == 0)
      return Wrong(setting.name, "not determined by planes, expected its standard uncertainty in place of estimate");
    if (random && setting.role == "estimate" && setting.u > 0)
      return Wrong(setting.name, "its variance is estimated without a prior, expected estimate or a number");
    if (index == Turntable::kNoiseZ && setting.role == "estimate")
      return Wrong(setting.name,
                   "expected its standard uncertainty in place of estimate: planes cannot tell it from noise_y");
    quantity.u = setting.u * UnitFactor(quantity.unit, dataset_.units);
    // Of what is random, none at all is a declaration too, which the residuals may contradict.
    const bool told = random && index != Turntable::kNoiseZ;
    quantity.role = setting.role == "estimate"                               ? Role::kEstimate
                    : setting.role == "consider" && (told || quantity.u > 0) ? Role::kConsider
                                                                             : Role::kHold;
    if (index == Turntable::kNoiseY && quantity.u == 0 && setting.role != "estimate")
      return Wrong(setting.name, "expected more than 0, or estimate: every point has noise");
    return {};
  }

  Result<void> SetForm(const InfluenceSetting& setting) {
    Quantity& first = model_.quantity(Turntable::kForm);
    if (first.role != Role::kHold) return Wrong(setting.name, "expected form or flatness, not both");
    if (setting.role == "estimate" && setting.u == 0)
      return Wrong(setting.name, "expected its size: form and offset cannot be told apart by the data alone");
    const double u = setting.u * dataset_.units.length_in_mm / (setting.name == "flatness" ? kPeakToValley : 1);
    for (int k = 0; k < kFormModes && u > 0; ++k) {
      model_.quantity(Turntable::kForm + k).role = setting.role == "estimate" ? Role::kEstimate : Role::kConsider;
      model_.quantity(Turntable::kForm + k).u = u;
    }
    return {};
  }

  Result<void> SetOnePlate(const InfluenceSetting& setting) {
    if (setting.role != "yes" && setting.role != "no") return Wrong(setting.name, "expected yes or no");
    for (int k = 0; k < kFormModes && setting.role == "yes"; ++k)
      model_.quantity(Turntable::kForm + k).scope = Scope::kSystem;
    return {};
  }

  Result<void> SetLineCorrelation(const InfluenceSetting& setting) {
    if (setting.role == "estimate") return {};
    if (setting.u > 0 && setting.u < 1)
      return Wrong(setting.name, "expected the integrated correlation length in points, 1 is white noise");
    if (setting.role == "hold") {
      for (const int k : {Turntable::kLineOffset, Turntable::kLineSlope}) model_.quantity(k).role = Role::kHold;
    } else {
      declaration_.line_correlation = std::max(1.0, setting.u);
    }
    return {};
  }

  Result<void> KeepForExpansion(const InfluenceSetting& setting) {
    if (setting.role == "estimate") return Wrong(setting.name, "expected a number");
    (setting.name == "temperature" ? temperature_ : expansion_) = setting.u;
    return {};
  }

  // M and N are of a mount at 20 degrees Celsius, known to temperature_ kelvin.
  Result<void> SetExpansion() {
    if (temperature_.has_value() != expansion_.has_value())
      return Wrong(temperature_ ? "temperature" : "expansion",
                   "expected temperature (K) and expansion (1/K) together: u of the mount's temperature and its "
                   "coefficient");
    if (!temperature_ || *temperature_ * *expansion_ == 0) return {};
    Quantity& quantity = model_.quantity(Turntable::kExpansion);
    quantity.role = Role::kConsider;
    quantity.u = *temperature_ * *expansion_;
    return {};
  }

  const Dataset& dataset_;
  Turntable& model_;
  TurntableDeclaration& declaration_;
  std::optional<double> temperature_, expansion_;
};

}  // namespace

Result<void> SetInfluences(const Dataset& dataset, Turntable* model, TurntableDeclaration* declaration) {
  return Setter(dataset, model, declaration).Run();
}

}  // namespace scancal
