// The one map from readings to the table frame: what residual, search and points must agree on.
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <cmath>
#include "models/turntable/use.h"
#include "solver/random.h"

namespace scancal::turntable {
namespace {

struct Draw {
  std::vector<double> q;  // by Model::Index; of the system and the target random, else 0
  double alpha = 0, y = 0, z = 0, bend = 0;
  Model::Motion motion;
};

Draw Drawn(uint64_t seed) {
  Random random(seed, 0);
  Draw draw;
  draw.q.assign(Model(Model::Residuals::kDepth).quantities().size(), 0.0);
  for (int k = 0; k <= Model::kDistance; ++k) draw.q[k] = 0.1 * random.Normal();  // far from linear
  draw.q[Model::kM] = 100 * random.Normal();
  draw.q[Model::kN] = 400 + 20 * random.Normal();
  draw.q[Model::kEncoderJitter] = 0.01 * random.Normal();
  draw.alpha = 3 * random.Normal();
  draw.y = 80 * random.Normal();
  draw.z = 60 * random.Normal();
  draw.bend = std::pow(random.Normal(), 2);
  for (int k = Model::kBacklash; k < Model::kLineOffset; ++k) draw.q[k] = 0.05 * random.Normal();
  draw.motion = {random.Uniform() < 0.5 ? -1.0 : 1.0, random.Normal(), {}};
  return draw;
}

Seen<double> SeenOf(const Draw& draw) { return {draw.q.data(), nullptr, static_cast<int>(draw.q.size())}; }

Eigen::Vector3d PointOf(const Draw& draw, double y) {
  return ProfileInTable<double>(draw.alpha, draw.q.data(), draw.motion).Point(y, draw.z, draw.bend);
}

System SystemIn(const Draw& draw) {
  System system{{}, {20, 140}, {-50, 60}};
  std::copy_n(draw.q.begin(), system.q.size(), system.q.begin());
  return system;
}

TEST(ProfileInTable, IsEquationSeven) {  // x = M cos a - (N + y) sin a, y = -M sin a - (N + y) cos a, z = z
  const System system{{-100, 400}, {}};
  const double a = 0.3;
  const Eigen::Vector3d p = system.Point(a, 50, 7);
  EXPECT_NEAR(p.x(), -100 * std::cos(a) - 450 * std::sin(a), 1e-11);
  EXPECT_NEAR(p.y(), 100 * std::sin(a) - 450 * std::cos(a), 1e-11);
  EXPECT_NEAR(p.z(), 7, 1e-12);
}

// The formula in the comment of ProfileInTable, by rotations of a library.
TEST(ProfileInTable, IsWhatItsCommentSays) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    const Draw draw = Drawn(seed);
    const auto q = [&](Model::Index k) { return draw.q[k]; };
    const double a = draw.alpha - q(Model::kEncoderCos1) * std::cos(draw.alpha) -
                     q(Model::kEncoderSin1) * std::sin(draw.alpha) - q(Model::kEncoderCos2) * std::cos(2 * draw.alpha) -
                     q(Model::kEncoderSin2) * std::sin(2 * draw.alpha) - q(Model::kEncoderScale) * draw.alpha -
                     q(Model::kEncoderJitter) - q(Model::kBacklash) * draw.motion.direction / 2 -
                     q(Model::kLatency) * draw.motion.speed;
    const auto with = [&](Model::Index k, int first) {
      return q(k) + draw.q[first] * std::cos(draw.alpha) + draw.q[first + 1] * std::sin(draw.alpha) +
             draw.q[first + 2] * std::cos(2 * draw.alpha) + draw.q[first + 3] * std::sin(2 * draw.alpha);
    };
    const double M = with(Model::kM, Model::kRunOut), N = with(Model::kN, Model::kRunOut + 4),
                 tilt_x = with(Model::kTiltX, Model::kWobble), tilt_y = with(Model::kTiltY, Model::kWobble + 4);
    const double y = (1 + q(Model::kScaleY) + q(Model::kRangeScale)) * draw.y + q(Model::kShear) * draw.z + draw.bend,
                 z = (1 + q(Model::kScaleZ) + q(Model::kRangeScale)) * draw.z;
    const Vector3d offset = (1 + q(Model::kExpansion)) * Vector3d(-M, N, 0);
    const Vector3d expected =
        AngleAxisd(-a, Vector3d::UnitZ()) * AngleAxisd(M_PI, Vector3d::UnitZ()) *
        Vector3d(AngleAxisd(tilt_y, Vector3d::UnitY()) * (AngleAxisd(tilt_x, Vector3d::UnitX()) * Vector3d(0, y, z)) +
                 offset);
    EXPECT_LT((PointOf(draw, draw.y) - expected).norm(), 1e-11) << seed;
  }
}

TEST(ProfileInTable, LiesAtTheDistanceFromThePlaneThatTheResidualSays) {
  Model::Target plane;
  Model::SetPlane({0.3, -0.9, 0.2}, 480, &plane);
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    const Draw draw = Drawn(seed);
    Model::View view;
    view.alpha = draw.alpha;
    view.points = {{1, draw.y, draw.z}};
    view.motion = draw.motion;
    view.bend = Eigen::RowVectorXd::Zero(std::ssize(Model::kBends));
    view.bend(0, 0) = draw.bend / draw.q[Model::kLinearity];
    const auto [normal, distance] = Model::Plane(plane, Eigen::Map<const Eigen::Vector3d>(&draw.q[Model::kNormal1]));
    const double expected = normal.dot(PointOf(draw, draw.y)) - distance;
    double r = 0;
    Model(Model::Residuals::kPlane).Residual(plane, view, SeenOf(draw), &r);
    EXPECT_NEAR(r, expected, 1e-11) << seed;
    Model(Model::Residuals::kDepth).Residual(plane, view, SeenOf(draw), &r);
    const double along_depth = normal.dot(PointOf(draw, draw.y + 0.5) - PointOf(draw, draw.y - 0.5));
    EXPECT_NEAR(r * along_depth, expected, 1e-12 * std::max(1.0, std::abs(expected))) << seed;
  }
}

TEST(System, BendsFromOneEndOfTheDepthsToTheOther) {
  System system{{}, {20, 140}, {-60, 60}};
  EXPECT_EQ(system.Bend(20, 30), 0);
  system[Model::kLinearity] = 1;
  EXPECT_EQ(system.Bend(20, 30), 1);
  EXPECT_EQ(system.Bend(80, 30), 0);
  EXPECT_EQ(system.Bend(140, 30), 1);
  EXPECT_EQ(system.Bend(110, 30), 0.25);
  for (size_t k = 0; k < Model::kBends.size(); ++k) {
    System bent{{}, {20, 140}, {-60, 60}};
    bent[Model::kBends[k]] = 2;
    constexpr std::array kShapes = {0.25, 0.125, 0.25, 0.25, 0.125};
    EXPECT_EQ(bent.Bend(110, 30), 2 * kShapes[k]) << k;
  }
}

TEST(System, DifferentiatesByEachOfItsQuantities) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const Draw draw = Drawn(seed);
    const System system = SystemIn(draw);
    const auto [point, by] = system.Differentiate(draw.alpha, draw.y, draw.z);
    EXPECT_LT((point - system.Point(draw.alpha, draw.y, draw.z)).norm(), 1e-11);
    for (size_t k = 0; k < system.q.size(); ++k) {
      constexpr double kStep = 1e-5;
      const auto moved = [&](double step) {
        System other = system;
        other[k] += step;
        return other.Point(draw.alpha, draw.y, draw.z);
      };
      const Eigen::Vector3d difference = (moved(kStep) - moved(-kStep)) / (2 * kStep);
      EXPECT_LT((difference - by.col(static_cast<Eigen::Index>(k))).norm(), 1e-6 * (1 + difference.norm())) << k;
    }
  }
}

Calibration CalibrationOf(const System& system) {
  Calibration calibration;
  const Quantities quantities = Model(Model::Residuals::kDepth).quantities();
  for (size_t k = 0; k < system.q.size(); ++k) {
    Parameter& parameter = calibration.parameters.emplace_back();
    parameter.name = quantities[k].name;
    parameter.value = system[k];
  }
  calibration.volume.columns = {"alpha", "y", "z", "X", "Y", "Z", "U_x", "U_y", "U_z", "U_max"};
  calibration.volume.rows = {{-0.2, 20, -50, 0, 0, 0, 0, 0, 0, 0}, {0.3, 140, 60, 0, 0, 0, 0, 0, 0, 0}};
  return calibration;
}

TEST(SystemOf, ACalibrationIsWhatItFound) {
  const System system = SystemIn(Drawn(1));
  const auto found = SystemOf(CalibrationOf(system));
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_EQ(found->q, system.q);
  EXPECT_EQ(found->depths, system.depths);
  EXPECT_EQ(found->heights, system.heights);
}

TEST(SystemOf, RefusesWhatIsNoTurntable) {
  Calibration calibration = CalibrationOf(SystemIn(Drawn(1)));
  std::erase_if(calibration.parameters, [](const Parameter& p) { return p.name == "N"; });
  EXPECT_NE(SystemOf(calibration).error().message.find("no parameter N"), std::string::npos);
  calibration = CalibrationOf(SystemIn(Drawn(1)));
  calibration.volume = {};  // an old file: of no consequence but for linearity
  EXPECT_NE(SystemOf(calibration).error().message.find("linearity"), std::string::npos);
  for (Parameter& parameter : calibration.parameters)
    if (parameter.name != "M" && parameter.name != "N") parameter.value = 0;
  EXPECT_TRUE(SystemOf(calibration).ok());
}

}  // namespace
}  // namespace scancal::turntable
