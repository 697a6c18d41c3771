#include "models/turntable/measured_point.h"
#include <gtest/gtest.h>
#include <cmath>
#include "models/turntable/calibrated_turntable.h"
#include "solver/random.h"

namespace scancal {
namespace {

constexpr int kSystemQuantities = Turntable::kNormal1;

struct Draw {
  std::vector<double> q;  // by Turntable::Index; of the system and the target random, else 0
  double alpha = 0, y = 0, z = 0, eta = 0;
};

Draw Drawn(uint64_t seed) {
  Random random(seed, 0);
  Draw draw;
  draw.q.assign(Turntable(Turntable::Residuals::kDepth).quantities().size(), 0.0);
  for (int k = 0; k <= Turntable::kDistance; ++k) draw.q[k] = 0.1 * random.Normal();  // far from linear
  draw.q[Turntable::kM] = 100 * random.Normal();
  draw.q[Turntable::kN] = 400 + 20 * random.Normal();
  draw.q[Turntable::kEncoderJitter] = 0.01 * random.Normal();
  draw.alpha = 3 * random.Normal();
  draw.y = 80 * random.Normal();
  draw.z = 60 * random.Normal();
  draw.eta = random.Normal();
  return draw;
}

Seen<double> SeenOf(const Draw& draw) { return {draw.q.data(), nullptr, static_cast<int>(draw.q.size())}; }

TEST(MeasuredPoint, LiesAtTheDistanceFromThePlaneThatTheResidualSays) {
  Turntable::Target plane;
  Turntable::SetPlane({0.3, -0.9, 0.2}, 480, &plane);
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    const Draw draw = Drawn(seed);
    Turntable::View view;
    view.alpha = draw.alpha;
    view.points = {{1, draw.y, draw.z}};
    view.bend = Eigen::VectorXd::Constant(1, draw.eta * draw.eta);
    const auto [normal, distance] =
        Turntable::Plane(plane, Eigen::Map<const Eigen::Vector3d>(&draw.q[Turntable::kNormal1]));
    const auto at = [&](double y) { return MeasuredPoint(draw.alpha, y, draw.z, draw.eta, SeenOf(draw)); };
    const double expected = normal.dot(at(draw.y)) - distance;
    double r = 0;
    Turntable(Turntable::Residuals::kPlane).Residual(plane, view, SeenOf(draw), &r);
    EXPECT_NEAR(r, expected, 1e-11) << seed;
    Turntable(Turntable::Residuals::kDepth).Residual(plane, view, SeenOf(draw), &r);
    const double along_depth = normal.dot(at(draw.y + 0.5) - at(draw.y - 0.5));  // it is linear in y
    EXPECT_NEAR(r * along_depth, expected, 1e-10) << seed;
  }
}

TEST(MeasuredPoint, EqualsThePoseWithoutFurtherErrors) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    Draw draw = Drawn(seed);
    std::fill(draw.q.begin() + Turntable::kShear, draw.q.end(), 0.0);
    const TurntablePose pose = {draw.q[Turntable::kM],     draw.q[Turntable::kN],      draw.q[Turntable::kTiltX],
                                draw.q[Turntable::kTiltY], draw.q[Turntable::kScaleY], draw.q[Turntable::kScaleZ]};
    EXPECT_LT(
        (MeasuredPoint(draw.alpha, draw.y, draw.z, draw.eta, SeenOf(draw)) - pose.Point(draw.alpha, draw.y, draw.z))
            .norm(),
        1e-11);
  }
}

TEST(MeasuredPoint, IsEquationSeven) {  // x = M cos a - (N + y) sin a, y = -M sin a - (N + y) cos a, z = z
  Draw draw;
  draw.q.assign(Turntable(Turntable::Residuals::kDepth).quantities().size(), 0.0);
  draw.q[Turntable::kM] = -100;
  draw.q[Turntable::kN] = 400;
  const double a = 0.3;
  const Eigen::Vector3d p = MeasuredPoint(a, 50, 7, 0.5, SeenOf(draw));
  EXPECT_NEAR(p.x(), -100 * std::cos(a) - 450 * std::sin(a), 1e-11);
  EXPECT_NEAR(p.y(), 100 * std::sin(a) - 450 * std::cos(a), 1e-11);
  EXPECT_NEAR(p.z(), 7, 1e-12);
}

Calibration CalibrationOf(const Draw& draw) {
  Calibration calibration;
  const Quantities quantities = Turntable(Turntable::Residuals::kDepth).quantities();
  for (int k = 0; k < kSystemQuantities; ++k) {
    Parameter& parameter = calibration.parameters.emplace_back();
    parameter.name = quantities[k].name;
    parameter.value = draw.q[k];
  }
  calibration.volume.columns = {"alpha", "y", "z", "X", "Y", "Z", "U_x", "U_y", "U_z", "U_max"};
  calibration.volume.rows = {{-0.2, 20, -50, 0, 0, 0, 0, 0, 0, 0}, {0.3, 140, 60, 0, 0, 0, 0, 0, 0, 0}};
  return calibration;
}

TEST(CalibratedTurntable, DifferentiatesByEveryQuantityOfTheSystem) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    Draw draw = Drawn(seed);
    draw.q[Turntable::kEncoderJitter] = 0;
    const auto turntable = CalibratedTurntable::From(CalibrationOf(draw));
    ASSERT_TRUE(turntable.ok()) << turntable.error().message;
    draw.eta = (2 * draw.y - 20 - 140) / 120;
    const auto [point, by] = turntable->Differentiate(draw.alpha, draw.y, draw.z);
    EXPECT_LT((point - turntable->Point(draw.alpha, draw.y, draw.z)).norm(), 1e-11);
    EXPECT_LT((point - MeasuredPoint(draw.alpha, draw.y, draw.z, draw.eta, SeenOf(draw))).norm(), 1e-11);
    ASSERT_EQ(by.cols(), kSystemQuantities);
    for (int k = 0; k < kSystemQuantities; ++k) {
      constexpr double kStep = 1e-5;
      const auto moved = [&](double step) {
        Draw other = draw;
        other.q[k] += step;
        return MeasuredPoint(draw.alpha, draw.y, draw.z, draw.eta, SeenOf(other));
      };
      const Eigen::Vector3d difference = (moved(kStep) - moved(-kStep)) / (2 * kStep);
      EXPECT_LT((difference - by.col(k)).norm(), 1e-6 * (1 + difference.norm())) << k;
    }
  }
}

TEST(CalibratedTurntable, RefusesWhatIsNoTurntable) {
  Calibration calibration = CalibrationOf(Drawn(1));
  std::erase_if(calibration.parameters, [](const Parameter& p) { return p.name == "N"; });
  EXPECT_NE(CalibratedTurntable::From(calibration).error().message.find("no parameter N"), std::string::npos);
  calibration = CalibrationOf(Drawn(1));
  calibration.volume = {};  // an old file: of no consequence but for linearity
  EXPECT_NE(CalibratedTurntable::From(calibration).error().message.find("linearity"), std::string::npos);
  calibration.parameters[Turntable::kLinearity].value = 0;
  EXPECT_TRUE(CalibratedTurntable::From(calibration).ok());
}

}  // namespace
}  // namespace scancal
