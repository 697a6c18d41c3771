// Poses of a KR 10 that show a scanner what it is to see.
#pragma once
#include <Eigen/Geometry>
#include <vector>
#include "models/parts/chain.h"
#include "solver/random.h"

namespace scancal {

// How far a pose may differ from looking straight, each drawn uniformly from -limit to limit; mm, rad.
struct PoseSpread {
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();   // about the scanner's axes
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // along them
};

class PosePlanner {
 public:
  PosePlanner(std::vector<Link> links, const Eigen::Isometry3d& flange_from_scanner)
      : links_(std::move(links)), flange_from_scanner_(flange_from_scanner) {}
  // Joint angles within the limits that bring the scanner there, or none.
  std::vector<double> Joints(const Eigen::Isometry3d& base_from_scanner, Random* random) const;

 private:
  std::vector<Link> links_;
  Eigen::Isometry3d flange_from_scanner_;
};

// Uniform, each from -limit to limit.
Eigen::Vector3d DrawWithin(const Eigen::Vector3d& limit, Random* random);

// `straight` turned and shifted within the spread.
Eigen::Isometry3d DrawPose(const Eigen::Isometry3d& straight, const PoseSpread& spread, Random* random);

}  // namespace scancal
