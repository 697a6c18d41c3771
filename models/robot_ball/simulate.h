// Data of a robot with known truth: the experiment of Zhou et al. 2025.
#pragma once
#include <cstdint>
#include <vector>
#include "models/robot_ball/kr10.h"
#include "models/robot_ball/measured.h"

namespace scancal {

// How the poses of a station differ (Table 2 of the paper). Spatial: the scanner is turned about all axes and moved
// along all. Planar: turned about one axis across its view and moved in a plane. Collinear: turned about its view and
// moved along a line. What a robot cannot help is there in all three.
enum class PoseConfiguration { kSpatial, kPlanar, kCollinear };

struct RobotScene {
  std::vector<Link> links = Kr10Links();  // six
  std::vector<Link> link_errors = PublishedLinkErrors();
  Eigen::Isometry3d flange_from_scanner = PublishedHandEye();
  int stations = 8,
      poses = 8;         // poses of each station: half of them look at one end of the artifact, half at the other
  int translations = 6;  // poses of the first station besides, that only translate from its first one
  PoseConfiguration configuration = PoseConfiguration::kSpatial;
  double field = 92;  // mm from the scanner's origin in which balls are seen: the published field's half diagonal
  double repeatability = 0.04;  // mm, standard deviation per axis of the flange's position, one error a pose
  double ball_noise = 0.035;    // mm, standard deviation per axis of a ball centre
  double u_spheres = 0.001;     // mm: of each coordinate of the artifact's CMM, and of the check distances
  int check_positions = 10;     // of a scale with two balls
  uint64_t seed = 1;            // of stations and poses
  uint64_t noise_seed = 1;      // of all that is measured
};

struct SimulatedRobot {
  RobotData data;
  RobotSetup truth;
  std::vector<Eigen::Isometry3d> base_from_artifact;  // truth, one a station
};

inline constexpr double kScaleLength = 299.546;  // mm, between the two balls of the check scale

// The artifact of the paper: about 1 m long, four balls at either end so that a scanner with a field of 100 mm sees
// four at once; 1006.863 mm from the first ball to the last, in its own frame with X along it.
std::vector<RobotBall::Sphere> PublishedArtifact();

// What is measured is made by the true chain, links + link_errors, and told with the nominal one and the commanded
// joint angles. Poses are planned on the nominal chain. Numbers of a station are streams of the seeds: they are the
// same for any number of stations, and other noise does not move the poses.
SimulatedRobot SimulateRobot(const RobotScene& scene);

}  // namespace scancal
