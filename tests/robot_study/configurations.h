// How the poses must differ: Table 2 of Zhou et al. 2025 on simulated data.
#pragma once
#include <Eigen/Core>
#include <vector>
#include "models/robot_ball/simulate.h"

namespace scancal::robot_study {

inline constexpr double kBallRadius = 6.35;  // mm

struct Reconstruction {  // of one ball, each entry a data set; mm
  robot_ball::PoseConfiguration configuration = robot_ball::PoseConfiguration::kSpatial;
  Eigen::VectorXd radius;
  double Error(double share) const;  // below which this share of the absolute errors of the radius lies
};

// The hand-eye from a single sphere (Ren 2012) at one station whose poses are collinear, planar or spatial; with it and
// the nominal robot the points on a ball, seen from eight other poses that are the same for all three, go to the base,
// where one sphere is fitted through all of them.
std::vector<Reconstruction> StudyConfigurations(const robot_ball::Scene& scene, size_t sets, int threads);

}  // namespace scancal::robot_study
