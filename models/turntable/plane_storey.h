// One placement compressed to what a search over M and N needs.
#pragma once
#include <Eigen/Core>
#include <vector>
#include "models/turntable/profile.h"

namespace scancal {

enum class PlaneFit {
  kVertical,    // Z = A X + B Y + C by least squares in Z, then orthogonal distances: eqs. (8)-(14)
  kOrthogonal,  // total least squares: right for every orientation
};

// With all other quantities known, the points P = M p_M + N p_N + p_0 are linear in M and N, and the 21 numbers of the
// triangle of (1, p_M, p_N, p_0) give every sum of squares: a node of the grid costs the same for a thousand points and
// for ten million.
class PlaneStorey {
 public:
  PlaneStorey(const std::vector<Profile>& profiles, turntable::System system);  // all of it but M and N
  double Rmse(double M, double N, PlaneFit fit) const;                          // eq. (14), mm
  // Total least squares plane at (M, N): unit normal with distance >= 0.
  std::pair<Eigen::Vector3d, double> FitPlane(double M, double N) const;

 private:
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  Eigen::Matrix3d Centred(double M, double N) const;  // upper triangular factor of (x, y, z) about their means
  double root_n_ = 0;
  Eigen::Matrix<double, 1, 5> mean_;  // of p_M (its x, -y), p_0 (x, y, z); times root_n_
  Vector5 cos_, sin_, x0_, y0_, z_;   // the same about the means
};

}  // namespace scancal
