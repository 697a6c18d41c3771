// The order of the methods: Table 4 and Figure 8 of Zhou et al. 2025 on simulated data.
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>
#include "models/robot_ball/simulate.h"

namespace scancal::robot_study {

struct Method {
  std::string name;
  Eigen::VectorXd max, mean;  // error of the sphere spacing at the check positions, one a data set, mm
};

// Nominal links with the hand-eye in closed form, Ren 2012, Mu 2017, the paper, the refinement with the declared noise;
// the scene with seeds of its own in every set. A method that fails on a set is an error of the study.
std::vector<Method> StudyMethods(const RobotScene& scene, size_t sets, int threads);

}  // namespace scancal::robot_study
