#include "tests/coverage/rows.h"
#include <fmt/format.h>
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
          of.All()};
}

}  // namespace scancal::coverage
