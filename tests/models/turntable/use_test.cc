// What a turntable's calibration says of measured points, against Monte Carlo and against repeated calibrations.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include "solver/dense.h"
#include "solver/random.h"
#include "tests/models/turntable/calibrated.h"

namespace scancal::turntable {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Reading {
  double alpha, y, z;
};
constexpr Reading kHere = {-12 * kDegree, 40, -70}, kThere = {15 * kDegree, 200, 80};

Eigen::Vector3d Located(const Reading& reading, const ScannedVolume& volume, const std::vector<double>& q) {
  System system{{}, volume.y};
  std::copy_n(q.begin(), system.q.size(), system.q.begin());
  return system.Point(reading.alpha, reading.y, reading.z);
}

PropagatedPoint At(const PointUncertainty& points, const Reading& reading) {
  return points.At(reading.alpha, reading.y, reading.z);
}

// Draws from the joint distribution pushed through the transform: covariance of a point, variance of a distance.
TEST(PointUncertainty, EqualsItsMonteCarlo) {
  constexpr int kTrials = 20000;
  const Calibration calibration = Calibrated(SmallScene(), ModelThatConsiders(kConsidered), NoErrors());
  const PointUncertainty points = PointsOf(calibration);
  const PropagatedPoint here = At(points, kHere), there = At(points, kThere);
  JointCovariance joint = JointOf(calibration);
  joint.Renew("expansion");
  ASSERT_EQ(joint.names.size(), 2 + kConsidered.size());
  const SymmetricEigen eigen = EigenOf(joint.matrix);
  const Eigen::MatrixXd factor = eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
  const Quantities quantities = ModelThatConsiders({}).quantities();
  std::vector<double> nominal = NoErrors();
  nominal[Model::kM] = calibration.Find("M")->value;
  nominal[Model::kN] = calibration.Find("N")->value;

  Random random(3, 0);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  double of_distance = 0;
  const double distance = (there.position - here.position).norm();
  for (int trial = 0; trial < kTrials; ++trial) {
    Eigen::VectorXd normal(factor.cols());
    for (double& each : normal) each = random.Normal();
    const Eigen::VectorXd errors = factor * normal;
    std::vector<double> q = nominal;
    for (size_t k = 0; k < joint.names.size(); ++k)
      q[Find(quantities, joint.names[k])] += errors[static_cast<Eigen::Index>(k)];
    const Eigen::Vector3d a = Located(kHere, points.volume(), q), b = Located(kThere, points.volume(), q);
    scatter += (a - here.position) * (a - here.position).transpose() / kTrials;
    of_distance += std::pow((b - a).norm() - distance, 2) / kTrials;
  }
  // A variance from n trials is known to sqrt(2 / n) of itself, a covariance to sqrt((c_ii c_jj + c_ij^2) / n).
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      const Eigen::Matrix3d& c = here.uncertainty.covariance;
      EXPECT_NEAR(scatter(i, j), c(i, j), 4 * std::sqrt((c(i, i) * c(j, j) + c(i, j) * c(i, j)) / kTrials)) << i << j;
    }
  }
  const PropagatedDistance stated = points.Between(here, there);
  EXPECT_NEAR(stated.value, distance, 1e-12);
  EXPECT_NEAR(of_distance / stated.uncertainty.covariance(0, 0), 1, 4 * std::sqrt(2.0 / kTrials));
}

// Simulate, refine, measure a point with the same instrument: its error scatters as stated.
TEST(PointUncertainty, EqualsTheScatterOfRepeatedCalibrations) {
  constexpr int kTrials = 200;
  const Model model = ModelThatConsiders(kConsidered);
  Scene scene = SmallScene();
  scene.profiles = 15;
  scene.points = 6;
  scene.encoder_jitter = 5e-5;
  Random random(5, 0);
  Eigen::Array3d scatter = Eigen::Array3d::Zero(), stated = scatter;
  double of_distance = 0, stated_distance = 0, normalised = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    scene.seed = static_cast<uint64_t>(trial) + 1;
    std::vector<double> truth = NoErrors();
    for (const auto& [k, u] : kConsidered) truth[k] = u * random.Normal();
    const Calibration calibration = Calibrated(scene, model, truth);
    truth[Model::kM] = scene.system.M();
    truth[Model::kN] = scene.system.N();
    truth[Model::kExpansion] = 1e-4 * random.Normal();  // another day
    const PointUncertainty points = PointsOf(calibration);
    const PropagatedPoint here = At(points, kHere), there = At(points, kThere);
    const Eigen::Vector3d a = Located(kHere, points.volume(), truth), b = Located(kThere, points.volume(), truth),
                          error = there.position - b;
    scatter += error.array().square() / kTrials;
    stated += there.uncertainty.covariance.diagonal().array() / kTrials;
    normalised += Cholesky(there.uncertainty.covariance).SolveLower(error).squaredNorm() / 3 / kTrials;
    const PropagatedDistance distance = points.Between(here, there);
    of_distance += std::pow(distance.value - (b - a).norm(), 2) / kTrials;
    stated_distance += distance.uncertainty.covariance(0, 0) / kTrials;
  }
  const double of_ratio = 4 / std::sqrt(2.0 * kTrials);  // a standard deviation from 200 trials is known to 5 %
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(std::sqrt(scatter[k] / stated[k]), 1, of_ratio) << k;
  EXPECT_NEAR(std::sqrt(of_distance / stated_distance), 1, of_ratio);
  EXPECT_NEAR(normalised, 1, 4 * std::sqrt(2.0 / (3 * kTrials)));
}

// All lengths found scale with depth: M and N move with the point.
TEST(PointUncertainty, ATrueScaleErrorMovesAPointByWhatUSays) {
  constexpr double kScale = 1e-3;
  Scene scene = SmallScene();
  scene.noise_y = 0;
  std::vector<double> q = NoErrors();
  q[Model::kScaleY] = kScale;
  const Calibration wrong = Calibrated(scene, ModelThatConsiders({{Model::kScaleY, kScale}}), q);
  const PropagatedPoint found = At(PointsOf(wrong), kHere);
  q[Model::kM] = scene.system.M();
  q[Model::kN] = scene.system.N();
  const Eigen::Vector3d error = found.position - Located(kHere, PointsOf(wrong).volume(), q);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(std::abs(error[i]), kScale * std::abs(found.position[i]), 2 * kScale * kScale * 500);
    EXPECT_NEAR(std::sqrt(found.uncertainty.covariance(i, i)), std::abs(error[i]), 2 * kScale * kScale * 500);
  }
  EXPECT_NEAR(found.uncertainty.covariance(0, 1), error[0] * error[1], 1e-2 * std::abs(error[0] * error[1]));
  EXPECT_NEAR(found.uncertainty.U_max, 1.96 * error.norm(), 0.01 * error.norm());
  // Against the budget: u of N alone is larger than what the depth itself adds, and has its sign.
  EXPECT_NEAR(wrong.Find("N")->u, kScale * scene.system.N(), 1e-3);
}

TEST(PointUncertainty, TheMountIsAsUncertainInUseAsItWasDuringTheCalibration) {
  constexpr double kExpansion = 1e-3;
  Scene scene = SmallScene();
  scene.noise_y = 0;
  const Calibration calibration = Calibrated(scene, ModelThatConsiders({{Model::kExpansion, kExpansion}}), NoErrors());
  EXPECT_NEAR(calibration.Find("M")->u, kExpansion * scene.system.M(), 1e-6);
  const PropagatedPoint point = PointsOf(calibration).At(0, 50, 0);
  EXPECT_NEAR(std::sqrt(point.uncertainty.covariance(0, 0)), std::sqrt(2) * kExpansion * scene.system.M(), 1e-5);
}

TEST(PointUncertainty, NeighboursShareTheirErrors) {
  const PointUncertainty points =
      PointsOf(Calibrated(SmallScene(), ModelThatConsiders({{Model::kScaleY, 1e-3}}), NoErrors()));
  const PropagatedPoint here = At(points, kHere), beside = points.At(kHere.alpha, kHere.y + 1, kHere.z);
  EXPECT_NEAR(points.Between(here, beside).uncertainty.covariance(0, 0), 1e-6, 1e-9);  // 1 mm of depth
  const PropagatedDistance none = points.Between(here, here);
  EXPECT_EQ(none.value, 0);
  EXPECT_EQ(none.uncertainty.U_max, 0);
}

TEST(PointUncertainty, NeedsABudgetThatNamesWhatWasConsidered) {
  Calibration calibration = Calibrated(SmallScene(), ModelThatConsiders({{Model::kScaleY, 1e-3}}), NoErrors());
  Calibration old = calibration;
  old.volume = {};
  EXPECT_THAT(PointUncertainty::From(old).error().message, HasSubstr("no volume"));
  for (BudgetLine& line : calibration.budget) line.sensitivity.clear();
  EXPECT_THAT(PointUncertainty::From(calibration).error().message, HasSubstr("a u of scale_y, but neither"));
  calibration.estimated.clear();
  calibration.covariance.resize(0, 0);
  EXPECT_THAT(PointUncertainty::From(calibration).error().message, HasSubstr("a u of M, but neither"));
}

Propagation Propagated(const Calibration& calibration, const std::string& typed) {
  auto result = Propagate(calibration, {typed, {}, {}}, true);
  EXPECT_TRUE(result.ok()) << result.error().message;
  return *std::move(result);
}

TEST(Propagate, NamesWhatAPointHasBesides) {
  Scene scene = SmallScene();
  scene.encoder_jitter = 1e-4;
  const Calibration calibration = Calibrated(scene, ModelThatConsiders({}), NoErrors());
  const Propagation result = Propagated(calibration, "10,50,0; -5,120,20; 10,50,0");
  ASSERT_EQ(result.points.size(), 3u);
  ASSERT_EQ(result.distances.size(), 2u);
  EXPECT_EQ(result.distances[1].from, 1u);
  EXPECT_EQ(result.distances[1].to, 2u);
  EXPECT_EQ(result.distances[0].value, result.distances[1].value);
  EXPECT_THAT(result.warnings, IsEmpty());
  ASSERT_EQ(result.notes.size(), 2u);
  EXPECT_THAT(result.notes[0], HasSubstr("u of one reading, 0.05"));
  EXPECT_THAT(result.notes[0], HasSubstr("(encoder_jitter)"));
  EXPECT_THAT(result.notes[1], HasSubstr("no u of Z"));
}

TEST(Propagate, WarnsOfWhatWasNotScanned) {
  const Calibration calibration = Calibrated(SmallScene(), ModelThatConsiders(kConsidered), NoErrors());
  const Propagation result = Propagated(calibration, "10,50,0; 10,50,300; 40,50,0");
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_THAT(result.warnings[0], HasSubstr("2 of 3 points"));
  EXPECT_THAT(result.warnings[0], HasSubstr("point 2: z = 300 mm"));
  EXPECT_EQ(result.notes.size(), 1u);  // Z has a u
}

TEST(Volume, SpansWhatWasScanned) {
  Scene scene = SmallScene();
  scene.noise_y = 0;
  const Calibration calibration = Calibrated(scene, ModelThatConsiders(kConsidered), NoErrors());
  const ScannedVolume volume = VolumeOf(calibration).value();
  double lowest = 1e9, highest = -1e9;
  for (const SimulatedPlacement& placement : Simulate(scene)) {
    for (const SimulatedProfile& profile : placement.profiles) {
      for (const double y : profile.y) {
        lowest = std::min(lowest, y);
        highest = std::max(highest, y);
      }
    }
  }
  EXPECT_NEAR(volume.alpha[0], -20 * kDegree, 1e-12);
  EXPECT_NEAR(volume.alpha[1], 20 * kDegree, 1e-12);
  // Eight points on a line: sqrt(9 / 7) of the length between the outermost.
  EXPECT_NEAR(volume.z[1], 100 * std::sqrt(9 / 7.0), 1e-9);
  EXPECT_NEAR(volume.z[0], -volume.z[1], 1e-9);
  const double line = 0.07 * (highest - lowest);
  EXPECT_NEAR(volume.y[0], lowest, line);
  EXPECT_NEAR(volume.y[1], highest, line);
  EXPECT_LE(volume.y[0], lowest);
  EXPECT_GE(volume.y[1], highest);
  EXPECT_THAT(volume.Beyond(0, 100, 0), IsEmpty());
  EXPECT_THAT(volume.Beyond(21 * kDegree, 1e4, 0), HasSubstr("alpha = 21 deg (scanned: -20 to 20 deg)"));
  EXPECT_THAT(volume.Beyond(0, 1e4, 0), HasSubstr("y = 1e+04 mm (scanned: "));
  EXPECT_THAT(volume.Beyond(0, 100, -150), HasSubstr("z = -150 mm (scanned: -113.4 to 113.4 mm)"));
}

TEST(Volume, HoldsWhatAPointThereWouldHave) {
  const Calibration calibration = Calibrated(SmallScene(), ModelThatConsiders(kConsidered), NoErrors());
  const PointUncertainty points = PointsOf(calibration);
  ASSERT_EQ(calibration.volume.rows.size(), 125u);
  EXPECT_EQ(calibration.volume.columns.size(), calibration.volume.units.size());
  for (const size_t i : {0, 31, 62, 124}) {
    const std::vector<double>& row = calibration.volume.rows[i];
    ASSERT_EQ(row.size(), calibration.volume.columns.size());
    const PropagatedPoint point = points.At(row[0], row[1], row[2]);
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(row[3 + k], point.position[k]);
      EXPECT_EQ(row[6 + k], point.uncertainty.U[k]);
      EXPECT_GE(row[9], row[6 + k]);
    }
    EXPECT_EQ(row[9], point.uncertainty.U_max);
  }
}

}  // namespace
}  // namespace scancal::turntable
