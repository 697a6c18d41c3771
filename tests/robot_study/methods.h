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

struct Mean {
  double value = 0, u = 0;  // u: its standard error
};
Mean MeanOf(const Eigen::VectorXd& values);

inline constexpr size_t kOrdered = 5;  // methods whose order is the paper's

// In the order of the paper: data sheet and drawing, Ren 2012, Mu 2017, Zhou 2025, the refinement with declared noise;
// then, apart, the paper's first hand-eye on nominal links. The scene with seeds of its own in every set. A method that
// fails on a set is a mistake of the study.
std::vector<Method> StudyMethods(const robot_ball::Scene& scene, size_t sets, int threads);

}  // namespace scancal::robot_study
