// The published search over M and N, compressed: Zhao et al., Sensors 2021, 21, 8359, eqs. (8) to (15), Algorithm 1.
#pragma once
#include <Eigen/Core>
#include <utility>
#include <vector>
#include "models/turntable/compress.h"
#include "solver/calibration.h"
#include "solver/grid_search.h"

namespace scancal::turntable {

enum class PlaneFit {
  kVertical,    // Z = A X + B Y + C by least squares in Z, then orthogonal distances: eqs. (8)-(14)
  kOrthogonal,  // total least squares: right for every orientation
};

// With all other quantities known, the points P = M p_M + N p_N + p_0 are linear in M and N, and the 21 numbers of the
// triangle of (1, p_M, p_N, p_0) give every sum of squares: a node of the grid costs the same for a thousand points and
// for ten million.
class PlaneStorey {
 public:
  PlaneStorey(const std::vector<Profile>& profiles, const System& system);  // all of it but M and N
  double Rmse(double M, double N, PlaneFit fit) const;                      // eq. (14), mm
  // Total least squares plane at (M, N): unit normal with distance >= 0.
  std::pair<Eigen::Vector3d, double> FitPlane(double M, double N) const;

 private:
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  Eigen::Matrix3d Centred(double M, double N) const;  // upper triangular factor of (x, y, z) about their means
  double root_n_ = 0;
  Eigen::Matrix<double, 1, 5> mean_;  // of p_M (its x, -y), p_0 (x, y, z); times root_n_
  Vector5 cos_, sin_, x0_, y0_, z_;   // the same about the means
};

std::vector<PlaneStorey> StoreysOf(const std::vector<Placement>& placements, const System& system);

// Eq. (15): the mean of the placements' rmse, mm.
double SAt(const std::vector<PlaneStorey>& storeys, double M, double N, PlaneFit fit);

// The minimum of S over the box. name: of the progress bar.
GridResult Search(const GridBox& box, const std::vector<PlaneStorey>& storeys, PlaneFit fit, const std::string& name);

// Calibration::surface, columns M, N, S (orthogonal), mm, N faster: "search", the nodes of the box thinned to at most
// 61 x 61, its first and last ones included, of the system as declared; "near", 41 x 41 in a square about the refined
// value that holds 3 U, and the minimum of the grid unless it is farther than three steps, of the system as found. A
// parameter that is not estimated has one node. Parameters and grid must be in place; where U is not finite there is no
// "near".
void AddSurface(const GridBox& box, const std::vector<PlaneStorey>& declared, const std::vector<PlaneStorey>& found,
                Calibration* calibration);

}  // namespace scancal::turntable
