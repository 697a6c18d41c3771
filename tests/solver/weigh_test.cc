#include "solver/weigh.h"
#include <gtest/gtest.h>
#include <Eigen/Dense>

namespace scancal {
namespace {

TEST(Whitening, MakesANonDiagonalCovarianceTheIdentity) {
  Eigen::Matrix3d v;
  v << 4, 1.8, 0.3, 1.8, 1.5, -0.4, 0.3, -0.4, 0.9;
  const Eigen::MatrixXd w = Whitening(v);
  EXPECT_LT((w * v * w.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-13);
  // The transposed factor, a mistake that good libraries shipped, does not.
  EXPECT_GT((w.transpose() * v * w - Eigen::Matrix3d::Identity()).norm(), 0.1);
}

TEST(Whitening, DividesBySigma) { EXPECT_NEAR(Whitening(Eigen::MatrixXd::Constant(1, 1, 0.25))(0, 0), 2, 1e-15); }

TEST(WhiteningDeathTest, RefusesARowWithoutNoise) {
  EXPECT_DEATH(Whitening(Eigen::Vector2d(1, 0).asDiagonal()), "noise of its own");
}

}  // namespace
}  // namespace scancal
