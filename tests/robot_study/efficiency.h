// The refinement against the best that any unbiased estimate can do.
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>
#include "tests/robot_study/declared.h"

namespace scancal::robot_study {

struct Efficiency {  // one entry an estimated parameter of the system
  std::vector<std::string> names;
  Eigen::VectorXd bound;  // standard deviation by Cramer and Rao: (J' V^-1 J)^-1 at the truth with the true V; mm, rad
  Eigen::VectorXd ratio;  // rms error over the runs / bound
  Eigen::VectorXd coverage;  // share of the runs whose value +- U holds the truth
  Eigen::VectorXd width;     // mean of U / (1.96 bound)
  double u_of_ratio = 0;     // standard error of ratio.mean(), by the correlations at the bound
  size_t runs = 0, failed = 0;
};

// The scene with other noise in every run. The bound knows the artifact exactly.
Efficiency StudyEfficiency(const robot_ball::Scene& scene, Noise noise, size_t runs, int threads);

}  // namespace scancal::robot_study
