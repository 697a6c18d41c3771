// Data of a robot with a line profiler, with known truth.
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <vector>
#include "io/result.h"
#include "models/robot_ball/simulate.h"
#include "models/robot_profiler.h"

namespace scancal::robot_profiler {

struct Scene {
  std::vector<Link> links = robot_ball::Kr10Links();
  std::vector<Link> link_errors;      // one a link; none: see Simulate
  Eigen::Isometry3d hand_eye;         // flange_from_profiler
  int planes = 6, poses = 15;         // poses on each plane
  int points = 60;                    // of a profile
  double line_length = 80;            // mm
  double noise = 0.02;                // mm, along depth
  double repeatability = 0;           // mm, of the flange, one error a pose and axis
  double repeatability_rotation = 0;  // rad, the same about each axis
  double scale_y = 0, scale_z = 0;    // relative; the shown reading times 1 + this is true
  uint64_t seed = 1, noise_seed = 1;  // of planes and poses; of what is measured
  Scene();                            // the profiler looks along the flange's axis and to the side
};

struct Simulated {
  std::vector<Link> link_errors;
  std::vector<Model::View> poses;  // joints and name
  struct Reading {
    size_t pose;
    double y, z;  // mm
  };
  std::vector<std::vector<Reading>> planes;  // profile by profile
};

// Links that are not given err by 0.3 mm and 1 mrad in each number that is estimated by default, so that these are what
// a calibration finds. Poses are planned on the nominal chain; depths are 90 to 130 mm.
Simulated Simulate(const Scene& scene);

// folder/dataset.yaml, poses.csv, plane1.csv ... and truth.json. Every digit is written.
Result<void> WriteSimulated(const Scene& scene, bool declare, const std::filesystem::path& folder);

}  // namespace scancal::robot_profiler
