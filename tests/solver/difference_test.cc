#include "solver/uncertainty/difference.h"
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include "solver/random.h"
#include "solver/uncertainty/control_chart.h"
#include "solver/uncertainty/gum.h"

namespace scancal {
namespace {

// Two parameters with noise of their own and what g, considered with u_g, does to them.
const Eigen::Vector2d kPerG = {2, -1};
const Eigen::Matrix2d kOwn{{0.09, -0.02}, {-0.02, 0.04}};

Calibration At(const Eigen::Vector2d& x, double u_g = 0.2, const Eigen::Vector2d& of_g = kPerG) {
  Calibration c;
  c.covariance = kOwn + u_g * u_g * of_g * of_g.transpose();
  for (int k = 0; k < 2; ++k) {
    Parameter& p = c.parameters.emplace_back();
    p.name = k == 0 ? "a" : "b";
    p.role = Role::kEstimate;
    p.value = x[k];
    p.u = std::sqrt(c.covariance(k, k));
    p.dof = kInfinity;
    c.estimated.push_back(p.name);
  }
  Parameter& g = c.parameters.emplace_back();
  g.name = "g";
  g.role = Role::kConsider;
  g.u = u_g;
  BudgetLine& line = c.budget.emplace_back();
  line.source.english = "g";
  line.u = u_g;
  line.sensitivity = {of_g[0], of_g[1]};
  return c;
}

CalibrationDifference Between(const Calibration& a, const Calibration& b, const std::set<std::string>& anew = {}) {
  return DifferenceOf(SeriesOf(std::vector{a, b}, anew));
}

Eigen::Vector2d Draw(Random* random) {
  const Eigen::Matrix2d l{{0.3, 0}, {-0.02 / 0.3, std::sqrt(0.04 - std::pow(0.02 / 0.3, 2))}};
  return l * Eigen::Vector2d(random->Normal(), random->Normal());
}

TEST(DifferenceOf, WhatBothDeclareCountsOnce) {
  const Eigen::Vector2d then(10, 20), now(10.5, 19);
  const CalibrationDifference same = Between(At(then), At(now));
  EXPECT_EQ(same.shared, std::vector<std::string>{"g"});
  EXPECT_NEAR(same.changes[0].change, 0.5, 1e-14);
  EXPECT_NEAR(same.changes[0].u, std::sqrt(2 * 0.09), 1e-12);
  EXPECT_NEAR(same.changes[0].E_n, 0.5 / (CoverageFactor(kCoverage, kInfinity) * std::sqrt(0.18)), 1e-9);
  EXPECT_LT(same.changes[1].E_n, 0);
  const Eigen::Vector2d d = now - then;
  EXPECT_NEAR(same.chi_squared, d.dot((2 * kOwn).inverse() * d), 1e-9);
  EXPECT_EQ(same.n, 2);
  const CalibrationDifference anew = Between(At(then), At(now), {"g"});
  EXPECT_TRUE(anew.shared.empty());
  EXPECT_NEAR(anew.changes[0].u, std::sqrt(2 * (0.09 + 0.16)), 1e-12);
  // Seen with other sensitivities it does not cancel; the larger u counts.
  const CalibrationDifference other = Between(At(then), At(now, 0.4, {5, 0}));
  EXPECT_NEAR(other.changes[0].u, std::sqrt(2 * 0.09 + 9 * 0.16), 1e-12);
}

TEST(DifferenceOf, OnlyWhatBothHaveEstimatedIsCompared) {
  Calibration fewer = At({10, 20});
  fewer.estimated = {"b"};
  fewer.covariance = Eigen::MatrixXd::Constant(1, 1, 0.04);
  fewer.budget.clear();
  const CalibrationDifference difference = Between(fewer, At({10, 21}));
  ASSERT_EQ(difference.changes.size(), 1U);
  EXPECT_EQ(difference.changes[0].name, "b");
  Calibration unknown = At({10, 20});
  unknown.covariance(0, 0) = std::nan("");
  EXPECT_TRUE(std::isnan(Between(unknown, At({10, 20})).changes[0].E_n));
  EXPECT_FALSE(Between(unknown, At({10, 90})).significant());
}

// Two calibrations of an instrument that stayed what it was, over and over: the stated U holds the change, and the test
// of all raises its alarm, as often as it says.
TEST(DifferenceOf, ItsUncertaintyAndItsTestHoldInRepeatedCalibrations) {
  constexpr int kTrials = 4000;
  Random random(1, 0);
  int within = 0, alarms = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const double g = 0.2 * random.Normal();
    const Eigen::Vector2d of_then(2, -1), of_now(3, 0.5);
    const CalibrationDifference difference =
        Between(At(Draw(&random) + of_then * g, 0.2, of_then), At(Draw(&random) + of_now * g, 0.2, of_now));
    within += std::abs(difference.changes[0].E_n) <= 1;
    alarms += difference.significant();
  }
  const double spread = std::sqrt(0.95 * 0.05 / kTrials);  // of a share
  EXPECT_NEAR(within / double{kTrials}, 0.95, 4 * spread);
  EXPECT_NEAR(alarms / double{kTrials}, 0.05, 4 * spread);
}

Calibration Turned(const Eigen::Vector3d& v, const Eigen::Matrix3d& covariance) {
  Calibration c;
  for (int k = 0; k < 3; ++k) {
    Parameter& p = c.parameters.emplace_back();
    p.name = std::string("hand_eye_r") + "xyz"[k];
    p.unit = Unit::kRad;
    p.role = Role::kEstimate;
    p.value = v[k];
    p.dof = kInfinity;
    c.estimated.push_back(p.name);
  }
  c.covariance = covariance;
  return c;
}
Eigen::Vector3d TurnBetween(const Calibration& a, const Calibration& b) {
  const CalibrationDifference difference = Between(a, b);
  return {difference.changes[0].change, difference.changes[1].change, difference.changes[2].change};
}
const Eigen::Matrix3d kTurns = Eigen::Matrix3d{{4.0, 1.0, 0.5}, {1.0, 9.0, -2.0}, {0.5, -2.0, 1.0}} * 1e-8;

TEST(DifferenceOf, AnOrientationIsOneRotation) {
  constexpr double kHalf = std::numbers::pi;
  const Eigen::Vector3d axis = Eigen::Vector3d(1, -0.4, 0.2).normalized();
  EXPECT_NEAR(TurnBetween(Turned((kHalf - 1e-4) * axis, kTurns), Turned(-(kHalf - 2e-4) * axis, kTurns)).norm(), 3e-4,
              1e-9);
  EXPECT_LT(TurnBetween(Turned(kHalf * axis, kTurns), Turned(-kHalf * axis, kTurns)).norm(), 1e-9);
  const Eigen::Vector3d v(1.2, -2.1, 0.7), turn(1e-3, 0, -2e-3);  // R = exp(turn) exp(v)
  const Eigen::AngleAxisd after(Eigen::AngleAxisd(turn.norm(), turn.normalized()) *
                                Eigen::AngleAxisd(v.norm(), v.normalized()));
  EXPECT_LT((TurnBetween(Turned(v, kTurns), Turned(after.angle() * after.axis(), kTurns)) - turn).norm(), 1e-12);
}

TEST(DifferenceOf, TheUOfARotationIsThatOfManyDraws) {
  const Eigen::Vector3d v(1.2, -2.1, 0.7);
  const Calibration reference = Turned(v, kTurns);
  const Eigen::Matrix3d l{
      {2e-4, 0, 0}, {0.5e-4, std::sqrt(8.75) * 1e-4, 0}, {0.25e-4, -2.125 / std::sqrt(8.75) * 1e-4, 0}};
  // What l leaves of the last variance.
  const double rest = 1e-8 - l.row(2).squaredNorm();
  ASSERT_GT(rest, 0);
  Random random(2, 0);
  constexpr int kTrials = 4000;
  Eigen::Array3d squares = Eigen::Array3d::Zero();
  for (int trial = 0; trial < kTrials; ++trial) {
    Eigen::Vector3d drawn = l * Eigen::Vector3d(random.Normal(), random.Normal(), 0);
    drawn[2] += std::sqrt(rest) * random.Normal();
    squares += TurnBetween(reference, Turned(v + drawn, kTurns)).array().square() / kTrials;
  }
  const CalibrationDifference difference = Between(reference, reference);
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(difference.changes[k].u / std::sqrt(2 * squares[k]), 1, 4 / std::sqrt(2.0 * kTrials)) << k;
}

std::vector<ControlChart> Charted(const std::vector<Calibration>& all) {
  std::vector<double> times;
  for (size_t i = 0; i < all.size(); ++i) times.push_back(static_cast<double>(i));
  return ChartsOf(SeriesOf(all, {}), times);
}

// What is common to all moves the centre, and is in its u; limits, drift and chi-squared do not see it.
TEST(ChartsOf, HoldInRepeatedHistories) {
  constexpr int kTrials = 1500, kCalibrations = 8;
  Random random(3, 0);
  double centres = 0, slopes = 0, improbable = 0, alarms = 0;
  ControlChart last;
  for (int trial = 0; trial < kTrials; ++trial) {
    const double g = 0.2 * random.Normal();
    std::vector<Calibration> all;
    for (int i = 0; i < kCalibrations; ++i) all.push_back(At(Draw(&random) + kPerG * g));
    last = Charted(all)[0];
    centres += last.centre * last.centre / kTrials;
    slopes += last.slope * last.slope / kTrials;
    improbable += last.p < 0.05;
    alarms += !last.quiet();
  }
  const double spread = 4 / std::sqrt(2.0 * kTrials);
  EXPECT_NEAR(last.u_centre, std::sqrt(0.09 / kCalibrations + 0.16), 1e-9);
  EXPECT_NEAR(last.u_slope, 0.3 / std::sqrt(42.0), 1e-9);  // sum of (i - 3.5)^2
  EXPECT_NEAR(std::sqrt(centres) / last.u_centre, 1, spread);
  EXPECT_NEAR(std::sqrt(slopes) / last.u_slope, 1, spread);
  EXPECT_NEAR(improbable / kTrials, 0.05, 4 * std::sqrt(0.95 * 0.05 / kTrials));
  EXPECT_LT(alarms / kTrials, 0.02);  // of one in two charts; 0.0014 a point, a slope and a few of the CUSUM
}

TEST(ChartsOf, ShiftDriftAndOutlierEachHaveTheirAlarm) {
  const auto charted = [](const std::vector<double>& in_u) {
    std::vector<Calibration> all;
    for (const double d : in_u) all.push_back(At({10 + 0.3 * d, 20}));
    return Charted(all)[0];
  };
  EXPECT_TRUE(charted({0.5, -0.5, 0.3, -0.2, 0, 0.4}).quiet());
  const ControlChart outlier = charted({0, 0, 0, 6, 0, 0, 0, 0});
  EXPECT_TRUE(outlier.points[3].beyond);
  EXPECT_FALSE(outlier.drifts);
  EXPECT_NEAR(outlier.points[3].deviation, 6 * std::sqrt(7.0 / 8), 1e-9);
  EXPECT_NEAR(outlier.points[3].high - outlier.centre, LimitsOf(2).k * 0.3 * std::sqrt(7.0 / 8), 1e-9);
  const ControlChart shift = charted({0, 0, 0, 0, 0, 0, 0, 0, 3.2, 3.2, 3.2, 3.2, 3.2, 3.2, 3.2, 3.2});
  EXPECT_FALSE(shift.points[8].beyond);  // 1.6 from the centre: no single one is conspicuous
  EXPECT_TRUE(shift.points[7].alarm);
  EXPECT_GT(shift.points[7].down, shift.points[7].up);
  const ControlChart drift = charted({0, 0.8, 1.6, 2.4, 3.2, 4.0, 4.8});
  EXPECT_TRUE(drift.drifts);
  EXPECT_NEAR(drift.slope, 0.24, 1e-9);
}

TEST(LimitsOf, AreThoseOfShewhartForOneChart) {
  EXPECT_NEAR(LimitsOf(1).k, 3, 1e-3);
  EXPECT_EQ(LimitsOf(1).h, 5);
  EXPECT_GT(LimitsOf(24).k, 3.7);
  EXPECT_LT(LimitsOf(24).k, 3.9);
}

}  // namespace
}  // namespace scancal
