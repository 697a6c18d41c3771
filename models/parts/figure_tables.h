// The tables of a result that figures are drawn from, as far as models share them. mm, rad.
#pragma once
#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>
#include "models/parts/chain.h"
#include "solver/calibration.h"

namespace scancal {

NumberTable TableOf(const std::vector<std::pair<std::string, Unit>>& columns);  // without rows

NumberTable PointTable();  // X, Y, Z
void AddPoint(const Eigen::Vector3d& p, NumberTable* points);

NumberTable SightTable();  // where the scanner was and the middle of what it saw: from_X .. from_Z, to_X .. to_Z
void AddSight(const Eigen::Vector3d& from, const Eigen::Vector3d& to, NumberTable* sights);

// Poses of a robot: q1 .. qn of the joints, x, y, z of the flange in the base, then `more`.
NumberTable PoseTable(size_t joints, const std::vector<std::pair<std::string, Unit>>& more);
void AddPose(const std::vector<double>& joints, const Eigen::Vector3d& flange, const std::vector<double>& more,
             NumberTable* poses);

// Residuals of points seen from those poses: pose (row of its table), x, y, z.
NumberTable PointResidualTable();

// Parameter::nominal of theta_1 .. beta_n.
void AddNominal(const std::vector<Link>& links, Calibration* calibration);

}  // namespace scancal
