#include "models/robot_ball/centre_adjustment.h"
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

namespace scancal {
namespace {

using Eigen::Index, Eigen::Matrix3d, Eigen::Matrix3Xd, Eigen::MatrixXd, Eigen::Vector3d, Eigen::VectorXd;

struct Conditions {
  MatrixXd A;         // a row per distance, eq. (11)
  VectorXd closures;  // measured minus CMM, eq. (12)
};

Conditions Distances(const Matrix3Xd& at, const Matrix3Xd& on_artifact) {
  const Index n = at.cols();
  Conditions conditions{MatrixXd::Zero(n * (n - 1) / 2, 3 * n), VectorXd(n * (n - 1) / 2)};
  Index row = 0;
  for (Index i = 0; i < n; ++i)
    for (Index j = i + 1; j < n; ++j, ++row) {
      const Vector3d between = at.col(i) - at.col(j);
      const double length = between.norm();
      conditions.A.block<1, 3>(row, 3 * i) = between.transpose() / length;
      conditions.A.block<1, 3>(row, 3 * j) = -between.transpose() / length;
      conditions.closures[row] = length - (on_artifact.col(i) - on_artifact.col(j)).norm();
    }
  return conditions;
}

// The angle at `apex` between two others, and its derivative by each.
struct Angle {
  double angle = 0;
  Vector3d by_apex, by_one, by_other;

  Angle(const Vector3d& apex, const Vector3d& one, const Vector3d& other) {
    const Vector3d a = one - apex, b = other - apex, normal = a.cross(b);
    angle = std::atan2(normal.norm(), a.dot(b));  // eq. (16), accurate near 0 and pi too
    by_one = a.cross(normal.normalized()) / a.squaredNorm();
    by_other = normal.normalized().cross(b) / b.squaredNorm();
    by_apex = -by_one - by_other;
  }
  // On a line the angle has no derivative.
  bool OnALine() const { return std::sin(angle) < 1e-6; }
};

struct AngleRows {
  MatrixXd B;
  VectorXd d;  // known minus measured
};

AngleRows Angles(const Matrix3Xd& at, const Matrix3Xd& on_artifact) {
  const Index n = at.cols();
  AngleRows rows{MatrixXd::Zero(n * (n - 1) * (n - 2) / 2, 3 * n), VectorXd::Zero(n * (n - 1) * (n - 2) / 2)};
  Index row = 0;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      for (Index k = j + 1; k < n; ++k) {
        if (j == i || k == i) continue;
        const Angle known(on_artifact.col(i), on_artifact.col(j), on_artifact.col(k));
        const Angle measured(at.col(i), at.col(j), at.col(k));
        if (known.OnALine() || measured.OnALine()) continue;
        rows.B.block<1, 3>(row, 3 * i) = measured.by_apex.transpose();
        rows.B.block<1, 3>(row, 3 * j) = measured.by_one.transpose();
        rows.B.block<1, 3>(row, 3 * k) = measured.by_other.transpose();
        rows.d[row++] = known.angle - measured.angle;
      }
  return {rows.B.topRows(row), rows.d.head(row)};
}

}  // namespace

CentreAdjustment AdjustByDistances(const Matrix3Xd& measured, const Matrix3Xd& on_artifact,
                                   const std::vector<Matrix3d>& spreads, int most_iterations) {
  constexpr double kStandsStill = 1e-13;  // of the coordinates
  CentreAdjustment result{measured};
  while (!result.converged && result.iterations++ < most_iterations) {
    const auto [A, closures] = Distances(result.centres, on_artifact);
    const Matrix3Xd moved = measured - result.centres;
    const VectorXd l = closures + A * moved.reshaped();
    MatrixXd by_unit = A;  // A S: dX = S y, the least |y| with A S y = -l
    for (Index i = 0; i < measured.cols(); ++i) by_unit.middleCols<3>(3 * i) *= spreads[i];
    const VectorXd y = Eigen::CompleteOrthogonalDecomposition<MatrixXd>(by_unit).solve(-l);
    Matrix3Xd next = measured;
    for (Index i = 0; i < measured.cols(); ++i) next.col(i) += spreads[i] * y.segment<3>(3 * i);
    result.converged = (next - result.centres).norm() <= kStandsStill * measured.norm();
    result.centres = next;
  }
  return result;
}

Matrix3Xd AdjustByAngles(const Matrix3Xd& measured, const Matrix3Xd& on_artifact) {
  constexpr double kRidge = 1e-3;
  const auto [B, d] = Angles(measured, on_artifact);
  if (B.rows() == 0) return measured;
  const Eigen::BDCSVD<MatrixXd> svd(B, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const VectorXd& sigma = svd.singularValues();
  const double k = std::pow(kRidge * sigma[0], 2);
  const VectorXd filter = sigma.array() / (sigma.array().square() + k);
  const VectorXd dX = svd.matrixV() * filter.cwiseProduct(svd.matrixU().transpose() * d);
  return measured + dX.reshaped(3, measured.cols());
}

RobotData AdjustCentres(RobotData data) {
  for (Station& station : data.stations)
    for (RobotBall::View& view : station.views) {
      const Index n = std::ssize(view.balls);
      Matrix3Xd measured(3, n), on_artifact(3, n);
      std::vector<Matrix3d> spreads;
      for (Index i = 0; i < n; ++i) {
        measured.col(i) = view.balls[i].centre;
        on_artifact.col(i) = data.spheres[view.balls[i].sphere].centre;
        spreads.push_back(view.balls[i].spread);
      }
      if (n < 2) continue;
      measured = AdjustByAngles(AdjustByDistances(measured, on_artifact, spreads).centres, on_artifact);
      for (Index i = 0; i < n; ++i) view.balls[i].centre = measured.col(i);
    }
  return data;
}

}  // namespace scancal
