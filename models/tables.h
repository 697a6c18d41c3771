// The tables of a result, as far as scanners share them. mm, rad.
#pragma once
#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>
#include "solver/calibration.h"

namespace scancal {

NumberTable TableOf(const std::vector<std::pair<std::string, Unit>>& columns);  // without rows

NumberTable PointTable();  // X, Y, Z
void AddPoint(const Eigen::Vector3d& p, NumberTable* points);

NumberTable SightTable();  // where the scanner was and the middle of what it saw: from_X .. from_Z, to_X .. to_Z
void AddSight(const Eigen::Vector3d& from, const Eigen::Vector3d& to, NumberTable* sights);

}  // namespace scancal
