// Data of a robot with known truth: the experiment of Zhou et al. 2025, on a six-axis arm of the KUKA KR 10 kind with
// the published errors.
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>
#include "io/result.h"
#include "models/robot_ball.h"
#include "solver/random.h"

namespace scancal::robot_ball {

// Nominal links of a KR 10 R1100: at q = (0, -90, 0, 0, 0, 0) degrees the upper arm stands up and the forearm points
// along +X of the base.
std::vector<Link> Kr10Links();

// Table 3 of Zhou et al. 2025, its angles read as degrees (as radians they would move the scanner by 15 mm). Link 2 has
// beta in place of d.
std::vector<Link> PublishedLinkErrors();

// flange_from_scanner as published with Table 3, made a rotation: its third row is printed without the sign that a
// right-handed frame needs. The scanner's origin lies in the middle of what it sees, its Z points back to the flange.
Eigen::Isometry3d PublishedHandEye();

// What a drawing would say of it: axes parallel to those of the flange, 265 mm along its Z.
Eigen::Isometry3d DrawnHandEye();

// Newton's method from `start` (rad, one a link) for an arm of six links, to rounding. None if it does not get there
// within a few dozen steps: out of reach, a singular posture, or a start on the wrong side.
std::optional<std::vector<double>> JointsFor(const std::vector<Link>& links, const Eigen::Isometry3d& base_from_flange,
                                             const std::vector<double>& start);

// Joint angles of a KR 10 within their limits that bring the flange there, from a few starts; empty: none were found.
std::vector<double> PlanJoints(const std::vector<Link>& links, const Eigen::Isometry3d& base_from_flange,
                               Random* random);

// How the poses of a station differ (Table 2 of the paper). Spatial: the scanner is turned about all axes and moved
// along all. Planar: turned about one axis across its view and moved in a plane. Collinear: turned about its view and
// moved along a line. What a robot cannot help is there in all three.
enum class PoseConfiguration { kSpatial, kPlanar, kCollinear };

struct Scene {
  std::vector<Link> links = Kr10Links();  // six
  std::vector<Link> link_errors = PublishedLinkErrors();
  Eigen::Isometry3d flange_from_scanner = PublishedHandEye();
  int stations = 8,
      poses = 8;         // poses of each station: half of them look at one end of the artifact, half at the other
  int translations = 6;  // poses of the first station besides, that only translate from its first one
  PoseConfiguration configuration = PoseConfiguration::kSpatial;
  double field = 92;  // mm from the scanner's origin in which balls are seen: the published field's half diagonal
  double repeatability = 0.04;           // mm, standard deviation per axis of the flange's position, one error a pose
  double repeatability_rotation = 0;     // rad, the same about each axis: the flange turns about its own origin
  std::vector<double> joint_terms = {};  // what the joints do besides (DeclareJointTerms); none: nothing
  double ball_noise = 0.035;             // mm, standard deviation per axis of a ball centre
  double u_spheres = 0.001;              // mm: of each coordinate of the artifact's CMM, and of the check distances
  int check_positions = 10;              // of a scale with two balls
  uint64_t seed = 1;                     // of stations and poses
  uint64_t noise_seed = 1;               // of all that is measured
};

struct Simulated {
  Measurements data;
  Kinematics truth;
  std::vector<Eigen::Isometry3d> base_from_artifact;  // truth, one a station
};

inline constexpr double kScaleLength = 299.546;  // mm, between the two balls of the check scale

// The artifact of the paper: about 1 m long, four balls at either end so that a scanner with a field of 100 mm sees
// four at once; 1006.863 mm from the first ball to the last, in its own frame with X along it.
std::vector<Model::Sphere> PublishedArtifact();

// What is measured is made by the true chain, links + link_errors, and told with the nominal one and the commanded
// joint angles. Poses are planned on the nominal chain. Numbers of a station are streams of the seeds: they are the
// same for any number of stations, and other noise does not move the poses.
Simulated Simulate(const Scene& scene);

// folder/dataset.yaml, poses.csv, balls.csv, artifact.csv, check_poses.csv, check_balls.csv, check_distances.csv and
// truth.json: the robot as it is, and in the numbers that a calibration finds (InDefaultGauge). Lengths are rounded to
// 1 nm, joint angles to 1e-9 deg. declare: noise and repeatability are written as influences. Refuses a scene with a
// count below one or a negative noise.
Result<void> WriteSimulated(const Scene& scene, bool declare, const std::filesystem::path& folder);

}  // namespace scancal::robot_ball
