#include "solver/dense.h"
#include <gtest/gtest.h>
#include <Eigen/Dense>
#include "solver/random.h"

namespace scancal {
namespace {

Eigen::MatrixXd RandomRows(int rows, int columns, uint64_t seed) {
  Random random(seed, 0);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random.Normal(); });
}

TEST(TriangularFactor, KeepsTheNormOfEveryCombination) {
  const Eigen::MatrixXd f = RandomRows(1000, 9, 1);
  TriangularFactor factor(9);
  factor.Add(f);
  const Eigen::MatrixXd t = RandomRows(9, 20, 2);
  for (int k = 0; k < t.cols(); ++k)
    EXPECT_NEAR((factor.R() * t.col(k)).norm(), (f * t.col(k)).norm(), 1e-12 * (f * t.col(k)).norm());
  EXPECT_TRUE(factor.R().isUpperTriangular(0));
}

TEST(TriangularFactor, MergesInAnyOrderAndAnyNumberOfParts) {
  const Eigen::MatrixXd f = RandomRows(333, 4, 3);
  TriangularFactor whole(4), first(4), second(4), one_by_one(4);
  whole.Add(f);
  first.Add(f.topRows(100));
  second.Add(f.bottomRows(233));
  second.Merge(first);
  for (int i = 332; i >= 0; --i) one_by_one.Add(f.row(i));
  for (const TriangularFactor* other : {&second, &one_by_one})
    EXPECT_LT((whole.R().cwiseAbs() - other->R().cwiseAbs()).norm(), 1e-12 * whole.R().norm());
}

TEST(TriangularFactor, KeepsTheCostOfAGoodFitThatTheGramMatrixLoses) {
  // Residuals of 5e-10 on coordinates of 1e3: F'F has lost them all.
  const Eigen::VectorXd x = 1e3 * (RandomRows(2000, 1, 4).array() + 3), noise = 5e-10 * RandomRows(2000, 1, 5);
  Eigen::MatrixXd f(2000, 2);
  f << x, x + noise;
  TriangularFactor factor(2);
  factor.Add(f);
  const Eigen::Vector2d t(1, -1);
  EXPECT_NEAR((factor.R() * t).squaredNorm(), (f * t).squaredNorm(), 1e-3 * (f * t).squaredNorm());
  const double gram = t.transpose() * (f.transpose() * f) * t;
  // Each term is a whole number of units in the last place of F'F, 4e-6 or more, and the cost is 5e-16: what is left is
  // zero or far too much, whichever way a machine rounds.
  EXPECT_GT(std::abs(gram / (f * t).squaredNorm() - 1), 0.999);
}

TEST(TriangularFactor, WithoutRowsIsZero) { EXPECT_EQ(TriangularFactor(3).R().norm(), 0); }

}  // namespace
}  // namespace scancal
