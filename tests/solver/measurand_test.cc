#include "solver/uncertainty/measurand.h"
#include <gtest/gtest.h>
#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include "solver/calibrate.h"
#include "solver/uncertainty/gum.h"
#include "tests/solver/line_model.h"

namespace scancal {
namespace {

void AddParameter(const std::string& name, Role role, double u, double dof, Calibration* c) {
  Parameter& p = c->parameters.emplace_back();
  p.name = name;
  p.role = role;
  p.u = u;
  p.dof = dof;
  if (role == Role::kEstimate) c->estimated.push_back(name);
}

// a, b estimated; g considered, with a sensitivity; h considered without one, it acts through a and b alone.
const Eigen::Vector2d kOfG = {2, -1};
constexpr double kUOfG = 0.2;
Calibration SomeCalibration() {
  Calibration c;
  AddParameter("a", Role::kEstimate, 0, 40, &c);
  AddParameter("g", Role::kConsider, kUOfG, 0, &c);
  AddParameter("b", Role::kEstimate, 0, 60, &c);
  AddParameter("h", Role::kConsider, 0.1, 0, &c);
  const Eigen::Matrix2d own{{0.09, -0.02}, {-0.02, 0.04}};
  c.covariance = own + kUOfG * kUOfG * kOfG * kOfG.transpose();
  c.budget.resize(3);
  c.budget[0].source.english = "noise";
  c.budget[0].u = 0.05;
  c.budget[1].source.english = "g";
  c.budget[1].u = kUOfG;
  c.budget[1].sensitivity = {kOfG[0], kOfG[1]};
  c.budget[2].source.english = "h";
  c.budget[2].u = 0.1;
  return c;
}

TEST(JointOf, PutsWhatWasConsideredBesideTheEstimates) {
  const Calibration c = SomeCalibration();
  const JointCovariance joint = JointOf(c);
  EXPECT_EQ(joint.names, (std::vector<std::string>{"a", "b", "g"}));
  Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
  expected.topLeftCorner<2, 2>() = c.covariance;
  expected.col(2) << 2 * 0.04, -0.04, 0.04;
  expected.row(2) = expected.col(2).transpose();
  EXPECT_LT((joint.matrix - expected).norm(), 1e-15);
  EXPECT_LT((joint.own - Eigen::Matrix2d{{0.09, -0.02}, {-0.02, 0.04}}).norm(), 1e-15);
}

TEST(UncertaintyOf, WhatAResultDependsOnTwiceCancelsOrCountsTwice) {
  const JointCovariance joint = JointOf(SomeCalibration());
  const double own = 0.09;
  for (const auto& [direct, left] : {std::pair{-2.0, 0.0}, {0.0, 2.0}, {2.0, 4.0}}) {  // f = a + direct g
    const MeasurandUncertainty f = UncertaintyOf(joint, Eigen::RowVector3d(1, 0, direct));
    EXPECT_NEAR(f.covariance(0, 0), own + std::pow(left * kUOfG, 2), 1e-14) << direct;
    EXPECT_NEAR(f.U[0], f.k * std::sqrt(f.covariance(0, 0)), 1e-14);
    EXPECT_EQ(f.U_max, f.U[0]);
  }
}

TEST(UncertaintyOf, CountsDegreesOfFreedomOfTheOwnPartOnly) {
  const JointCovariance joint = JointOf(SomeCalibration());
  // Welch-Satterthwaite backwards: u(a)^4 / 40 = own(a)^2 / dof, u(a)^2 = 0.09 + 0.16.
  const double of_a = 40 * std::pow(0.09 / 0.25, 2), of_b = 60 * std::pow(0.04 / 0.08, 2);
  EXPECT_NEAR(UncertaintyOf(joint, Eigen::RowVector3d(1, 0, 0)).dof, 40, 1e-10);
  EXPECT_NEAR(UncertaintyOf(joint, Eigen::RowVector3d(1, 0, -2)).dof, of_a, 1e-10);
  EXPECT_NEAR(UncertaintyOf(joint, Eigen::RowVector3d(0, 1, 1)).dof, of_b, 1e-10);
  EXPECT_NEAR(UncertaintyOf(joint, Eigen::RowVector3d(1, 1, -1)).dof, of_a, 1e-10);  // g cancels; a has fewer than b
  EXPECT_EQ(UncertaintyOf(joint, Eigen::RowVector3d(0, 0, 1)).dof, kInfinity);
  EXPECT_NEAR(UncertaintyOf(joint, Eigen::RowVector3d(0, 0, 1)).k, 1.96, 0.0005);
  EXPECT_GT(UncertaintyOf(joint, Eigen::RowVector3d(1, 0, -2)).k, 2.5);  // 5.2 degrees of freedom
}

TEST(UncertaintyOf, FindsTheDirectionThatIsKnownLeast) {
  const JointCovariance joint = JointOf(SomeCalibration());
  Eigen::MatrixXd by(2, 3);
  by << 1, 0.5, 0.2, 1, -1, -1;
  const MeasurandUncertainty f = UncertaintyOf(joint, by);
  double largest = 0;
  for (double angle = 0; angle < M_PI; angle += 1e-4) {
    const Eigen::RowVector2d along(std::cos(angle), std::sin(angle));
    largest = std::max(largest, std::sqrt(along * f.covariance * along.transpose()));
  }
  EXPECT_NEAR(f.U_max, f.k * largest, 1e-6 * f.U_max);
  EXPECT_GT(f.U_max, 1.01 * f.U.maxCoeff());
}

TEST(UncertaintyOf, SaysInfiniteWhereNothingIsKnown) {
  Calibration c = SomeCalibration();
  c.covariance(0, 0) = std::nan("");
  const MeasurandUncertainty f = UncertaintyOf(JointOf(c), Eigen::RowVector3d(1, 0, 0));
  EXPECT_EQ(f.U[0], kInfinity);
  EXPECT_EQ(f.U_max, kInfinity);
}

TEST(JointCovariance, ARenewedQuantityIsIndependentAndAsUncertain) {
  JointCovariance joint = JointOf(SomeCalibration());
  joint.Renew("g");
  joint.Renew("not there");
  // a + 2 g: what g did to a, and what the new g does.
  EXPECT_NEAR(UncertaintyOf(joint, Eigen::RowVector3d(1, 0, 2)).covariance(0, 0), 0.25 + 4 * 0.04, 1e-14);
}

// The height of a line at some x, found with a curvature that is supposed to be 0 and is not: u must say how far it is
// off, between the data where both errors cancel, and beyond them.
TEST(UncertaintyOf, EqualsTheScatterOfRepeatedCalibrations) {
  constexpr int kTrials = 600;
  constexpr double kCurvature = 0.02;  // standard uncertainty; alone it moves the slope by 0.1
  LineModel model;
  model.quantity(LineModel::kCurvature).role = Role::kConsider;
  model.quantity(LineModel::kCurvature).u = kCurvature;
  Random random(1, 0);
  const Eigen::Array2d x = {3, 12};
  Eigen::Array2d scatter = {0, 0}, stated = {0, 0};
  for (int trial = 0; trial < kTrials; ++trial) {
    LineScene scene;
    scene.curvature = kCurvature * random.Normal();
    scene.seed = static_cast<uint64_t>(trial) + 1;
    Problem problem = MakeProblem<LineModel>(std::make_shared<LineModel>(model), scene.Make());
    problem.WeighEqually(scene.noise);
    const Estimate start = NominalStart(problem);
    const Calibration result = Summarize(Solve(std::move(problem), start), {});
    const JointCovariance joint = JointOf(result);
    scatter += ((result.Find("slope")->value - scene.slope) * x - scene.curvature * x * x).square() / kTrials;
    for (int k = 0; k < 2; ++k)
      stated[k] += UncertaintyOf(joint, Eigen::RowVector2d(x[k], x[k] * x[k])).covariance(0, 0) / kTrials;
  }
  // A standard deviation from 600 trials is known to 2.9 %. Without the correlation u would be 2.5 and 1.9 times as
  // large.
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(std::sqrt(stated[k] / scatter[k]), 1, 4 / std::sqrt(2.0 * kTrials)) << x[k];
}

}  // namespace
}  // namespace scancal
