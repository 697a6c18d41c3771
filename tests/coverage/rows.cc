#include "tests/coverage/rows.h"
#include <fmt/format.h>
#include <numbers>

namespace scancal::coverage {
namespace {

constexpr double kDegree = std::numbers::pi / 180, kArcsecond = kDegree / 3600, kMicron = 1e-3;

TurntableScene White() {
  TurntableScene scene;
  scene.profiles = scene.points = 100;
  scene.sweep = 44 * kDegree;
  return scene;
}

Row Jitter(double arcseconds) {
  Row row{fmt::format("jitter {:g} arcsec", arcseconds), White()};
  row.scene.encoder_jitter = arcseconds * kArcsecond;
  row.widest = 1.15;
  return row;
}

Row LineCorrelation(double points) {
  Row row{fmt::format("line correlation {:g} points", points), White()};
  row.scene.line_correlation = points;
  row.widest = 1.2;
  return row;
}

}  // namespace

std::vector<Row> Rows() {
  Row white{"white", White()};
  white.least = 0.935;
  white.most = 0.965;
  white.widest = 1.05;
  return {white, Jitter(5), Jitter(20), LineCorrelation(40), LineCorrelation(130)};
}

}  // namespace scancal::coverage
