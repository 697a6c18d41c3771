#include "tests/coverage/rows.h"
#include <fmt/format.h>
#include <string>
#include "io/units.h"

namespace scancal::coverage {
namespace {

constexpr double kArcsecond = kDegree / 3600, kMicron = 1e-3;

class Scenes {
 public:
  explicit Scenes(double sweep_deg) {
    base_.profiles = base_.points = 100;
    base_.sweep = sweep_deg * kDegree;
  }

  Row White() const {
    Row row{"white noise", base_};
    row.least = 0.935;
    row.most = 0.965;
    row.widest = 1.05;
    return row;
  }

  Row Jitter(double arcseconds) const {
    Row row{fmt::format("jitter {:g} arcsec", arcseconds), base_};
    row.scene.encoder_jitter = arcseconds * kArcsecond;
    row.widest = 1.15;
    return row;
  }

  Row Form(double microns) const {
    Row row{fmt::format("form {:g} um", microns), base_};
    row.scene.form = row.declared_form = microns * kMicron;
    row.widest = 1.3;
    return row;
  }

  // Functions that are not among the modes of the declared ensemble.
  Row OtherForm(double microns, turntable::FormKind kind) const {
    Row row = Form(microns);
    row.name += kind == turntable::FormKind::kSmooth ? ", other functions" : ", bent plates";
    row.scene.form_kind = kind;
    row.most = 1;
    row.widest = std::numeric_limits<double>::infinity();
    return row;
  }

  Row LineCorrelation(double points) const {
    Row row{fmt::format("line correlation {:g} points", points), base_};
    row.scene.line_correlation = points;
    row.widest = 1.2;
    return row;
  }

  // Estimated, as sweeps there and back tell it. What they do not tell, whether it goes on from scan to scan, widens
  // the intervals unless it is declared.
  Row DriftBothWays(bool begins_anew) const {
    Row row{"drift 0.2 mm over sweeps there and back", base_};
    if (begins_anew) row.name += ", drift: 0";
    row.begins_anew = begins_anew;
    row.most = begins_anew ? 0.97 : 1;
    row.scene.back = true;
    row.scene.drift_sweep = 0.2;
    return row;
  }

  Row Declared(const std::string& name, const std::vector<turntable::Model::Index>& quantities, double u) const {
    Row row{name, base_};
    row.draw = [=](Random* random, turntable::Scene* scene) {
      for (const turntable::Model::Index k : quantities) {
        const double value = u * random->Normal();
        if (k == turntable::Model::kDriftSweep) scene->drift_sweep = value;
        else if (k == turntable::Model::kDrift) scene->drift = value;
        else scene->system[k] = value;
      }
    };
    row.declare = [=](turntable::Model* model) {
      for (const turntable::Model::Index k : quantities) {
        model->quantity(k).role = Role::kConsider;
        model->quantity(k).u = u;
      }
    };
    return row;
  }

  Row Neighbours(double correlation) const {
    Row row{fmt::format("profiles err by 20 um, neighbours correlated {:g}", correlation), base_};
    row.scene.profile_offset = 20 * kMicron;
    row.scene.profile_correlation = correlation;
    return row;
  }

  Row CoarseAngle(double step_deg) const {
    Row row{fmt::format("angle in steps of {:g} deg", step_deg), base_};
    row.scene.angle_step = step_deg * kDegree;
    row.most = 1;
    return row;
  }

  Row OnePlate(double microns, bool declared) const {
    Row row = Form(microns);
    row.name += declared ? ", one plate" : ", one plate, not declared";
    row.scene.one_plate = true;
    row.most = declared ? 0.97 : 1;
    row.widest = std::numeric_limits<double>::infinity();
    row.declare = [declared](turntable::Model* model) {
      for (int k = 0; k < turntable::kFormModes; ++k) {
        Quantity& mode = model->quantity(turntable::Model::kForm + k);
        if (declared) mode.scope = Scope::kSystem;
        else mode.perhaps_shared = true;
      }
    };
    return row;
  }

  Row All() const {
    Row row = Form(5);
    row.name = "jitter 20, form 5, correlation 40, 2 % outliers";
    row.scene.encoder_jitter = 20 * kArcsecond;
    row.scene.line_correlation = 40;
    row.scene.outliers = 0.02;
    row.least = 0.92;
    row.most = 0.98;
    row.widest = 1.4;
    return row;
  }

 private:
  turntable::Scene base_;
};

}  // namespace

std::vector<Row> Rows(double sweep_deg) {
  const Scenes of(sweep_deg);
  using enum turntable::FormKind;
  using turntable::Model;
  return {of.White(),
          of.Jitter(5),
          of.Jitter(20),
          of.Form(2),
          of.Form(5),
          of.Form(15),
          of.OtherForm(2, kSmooth),
          of.OtherForm(5, kSmooth),
          of.OtherForm(15, kSmooth),
          of.OtherForm(5, kBent),
          of.LineCorrelation(40),
          of.LineCorrelation(130),
          of.All(),
          of.DriftBothWays(true),
          of.DriftBothWays(false),
          of.Declared("drift 50 um over each sweep, declared", {Model::kDriftSweep}, 50 * kMicron),
          of.Declared("lens: linearity_3, lens_z2, lens_yz2 of 10 um, declared",
                      {Model::kLinearity3, Model::kLensZ2, Model::kLensYZ2}, 10 * kMicron),
          of.Declared("encoder_scale 1e-4, declared", {Model::kEncoderScale}, 1e-4),
          of.Neighbours(0.5),
          of.Neighbours(0.8),
          of.Neighbours(0.9),
          of.CoarseAngle(0.2),
          of.OnePlate(5, true),
          of.OnePlate(5, false)};
}

}  // namespace scancal::coverage
