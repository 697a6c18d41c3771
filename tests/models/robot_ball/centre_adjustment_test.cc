// Ball centres adjusted to the CMM's distances and angles.
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include "models/robot_ball/published.h"
#include "models/robot_ball/simulate.h"
#include "solver/dense.h"
#include "solver/random.h"

namespace scancal::robot_ball {
namespace {

using Eigen::Matrix3d, Eigen::Matrix3Xd, Eigen::Vector3d;

struct SeenArtifact {
  Matrix3Xd on_artifact, measured;
  std::vector<Matrix3d> spreads;
};

// Balls of the artifact seen from somewhere with noise; spread: whether it differs by ball and direction.
SeenArtifact SeenFrom(int balls, double noise, bool spread, uint64_t seed) {
  SeenArtifact scene{Matrix3Xd(3, balls), Matrix3Xd(3, balls), {}};
  const std::vector<Model::Sphere> spheres = PublishedArtifact();
  Random random(seed, 0);
  for (int i = 0; i < balls; ++i) {
    scene.on_artifact.col(i) = spheres[i].centre;
    Matrix3d S = Matrix3d::Identity();
    if (spread)
      for (double& s : S.reshaped()) s += 0.4 * random.Normal();
    scene.spreads.push_back(S);
    scene.measured.col(i) = PoseOf({20, -40, 350, 0.5, -1.2, 0.7}) * scene.on_artifact.col(i) +
                            noise * S * Eigen::Vector3d::NullaryExpr([&] { return random.Normal(); });
  }
  return scene;
}

Matrix3Xd Carried(const Eigen::Isometry3d& pose, const Matrix3Xd& points) {
  return (pose.linear() * points).colwise() + pose.translation();
}

// The artifact fitted rigidly: unweighted by Umeyama; weighted by Gauss-Newton over its pose.
Matrix3Xd RigidFit(const SeenArtifact& scene) {
  Eigen::Isometry3d pose;
  pose = MotionOnto(scene.on_artifact, scene.measured);
  for (int k = 0; k < 20; ++k) {
    const Matrix3Xd fitted = Carried(pose, scene.on_artifact);
    Eigen::MatrixXd J(fitted.size(), 6);
    Eigen::VectorXd r(fitted.size());
    for (Eigen::Index i = 0; i < fitted.cols(); ++i) {
      const Vector3d arm = fitted.col(i) - pose.translation();
      Matrix3d turn;
      turn << 0, arm[2], -arm[1], -arm[2], 0, arm[0], arm[1], -arm[0], 0;  // d (w x arm) / d w
      const Matrix3d weight = scene.spreads[i].inverse();
      J.middleRows<3>(3 * i) << weight, weight * turn;
      r.segment<3>(3 * i) = weight * (scene.measured.col(i) - fitted.col(i));
    }
    const Eigen::Matrix<double, 6, 1> step = LeastSquares(J, r);
    pose.translation() += step.head<3>();
    pose.linear() =
        PoseOf((Eigen::Matrix<double, 6, 1>() << Vector3d::Zero(), step.tail<3>()).finished()).linear() * pose.linear();
  }
  return Carried(pose, scene.on_artifact);
}

double Largest(const Matrix3Xd& difference) { return difference.colwise().norm().maxCoeff(); }

TEST(AdjustByDistances, ConvergesToTheRigidFit) {
  for (const int balls : {3, 4, 5, 8}) {
    const SeenArtifact scene = SeenFrom(balls, 0.035, false, 7);
    const CentreAdjustment adjusted = AdjustByDistances(scene.measured, scene.on_artifact, scene.spreads);
    EXPECT_TRUE(adjusted.converged) << balls;
    Matrix3Xd rigid = Carried(MotionOnto(scene.on_artifact, scene.measured), scene.on_artifact);
    EXPECT_LT(Largest(adjusted.centres - rigid), 1e-11) << balls << " balls, " << adjusted.iterations;
    EXPECT_GT(Largest(adjusted.centres - scene.measured), 0.01);
  }
}

TEST(AdjustByDistances, OneStepIsNotEnough) {
  const SeenArtifact scene = SeenFrom(8, 0.035, false, 7);
  const CentreAdjustment one = AdjustByDistances(scene.measured, scene.on_artifact, scene.spreads, 1);
  EXPECT_FALSE(one.converged);
  const double off = Largest(one.centres - RigidFit(scene));
  EXPECT_GT(off, 1e-6);
  EXPECT_LT(off, 2e-3);
}

TEST(AdjustByDistances, WeighsBallsAndDirections) {
  for (const int balls : {3, 4, 8}) {
    const SeenArtifact scene = SeenFrom(balls, 0.035, true, 11);
    const CentreAdjustment adjusted = AdjustByDistances(scene.measured, scene.on_artifact, scene.spreads);
    EXPECT_TRUE(adjusted.converged) << balls;
    EXPECT_LT(Largest(adjusted.centres - RigidFit(scene)), 1e-11) << balls;
    const std::vector<Matrix3d> ones(balls, Matrix3d::Identity());
    const Matrix3Xd unweighted = AdjustByDistances(scene.measured, scene.on_artifact, ones).centres;
    EXPECT_GT(Largest(adjusted.centres - unweighted), 1e-3);
  }
}

TEST(AdjustByDistances, TwoBallsShareTheError) {
  SeenArtifact scene = SeenFrom(2, 0, false, 1);
  const Vector3d along = (scene.measured.col(0) - scene.measured.col(1)).normalized();
  const Matrix3Xd exact = scene.measured;
  scene.measured.col(0) += 0.1 * along;
  scene.spreads[0] *= 2;  // four times the variance: takes four fifths of the correction
  const Matrix3Xd adjusted = AdjustByDistances(scene.measured, scene.on_artifact, scene.spreads).centres;
  EXPECT_LT((adjusted.col(0) - (exact.col(0) + 0.02 * along)).norm(), 1e-12);
  EXPECT_LT((adjusted.col(1) - (exact.col(1) + 0.02 * along)).norm(), 1e-12);
}

TEST(AdjustByAngles, ChangesNothingAfterTheDistances) {
  const SeenArtifact scene = SeenFrom(8, 0.035, true, 3);
  const Matrix3Xd adjusted = AdjustByDistances(scene.measured, scene.on_artifact, scene.spreads).centres;
  EXPECT_LT(Largest(AdjustByAngles(adjusted, scene.on_artifact) - adjusted), 1e-11);
}

TEST(AdjustByAngles, RemovesErrorsOfAngles) {
  const SeenArtifact scene = SeenFrom(8, 0.035, false, 3);
  const auto angle = [](const Matrix3Xd& at, int i, int j, int k) {
    const Vector3d a = at.col(j) - at.col(i), b = at.col(k) - at.col(i);
    return std::atan2(a.cross(b).norm(), a.dot(b));
  };
  const auto rms = [&](const Matrix3Xd& at) {
    double sum = 0;
    for (int i = 0; i < 8; ++i)
      for (int j = 0; j < 8; ++j)
        for (int k = 0; k < j; ++k)
          if (i != j && i != k) sum += std::pow(angle(at, i, j, k) - angle(scene.on_artifact, i, j, k), 2);
    return std::sqrt(sum / 168);
  };
  const Matrix3Xd adjusted = AdjustByAngles(scene.measured, scene.on_artifact);
  EXPECT_LT(rms(adjusted), 0.05 * rms(scene.measured));
  EXPECT_LT(Largest(adjusted - scene.measured), 0.3);  // ridge: no wild move along what angles do not see
}

TEST(AdjustCentres, EveryPoseBecomesRigid) {
  Scene scene;
  scene.stations = 2;
  Measurements data = Simulate(scene).data;
  data.stations[0].views[0].balls.resize(1);
  const Vector3d alone = data.stations[0].views[0].balls[0].centre;
  const Measurements adjusted = AdjustCentres(data);
  EXPECT_EQ(adjusted.stations[0].views[0].balls[0].centre, alone);
  for (const Station& station : adjusted.stations)
    for (const Model::View& view : station.views)
      for (const auto& a : view.balls)
        for (const auto& b : view.balls)
          EXPECT_NEAR((a.centre - b.centre).norm(),
                      (data.spheres[a.sphere].centre - data.spheres[b.sphere].centre).norm(), 1e-10);
}

}  // namespace
}  // namespace scancal::robot_ball
