#include "models/robot_ball/kr10.h"
#include <Eigen/SVD>
#include "io/units.h"

namespace scancal {
namespace {}  // namespace

std::vector<Link> Kr10Links() {
  constexpr double kQuarter = 90 * kDegree;
  return {{0, 400, 25, -kQuarter, 0}, {0, 0, 560, 0, 0},       {0, 0, 35, -kQuarter, 0},
          {0, 515, 0, kQuarter, 0},   {0, 0, 0, -kQuarter, 0}, {0, 80, 0, 0, 0}};
}

std::array<JointLimits, 6> Kr10Limits() {
  std::array<JointLimits, 6> limits = {{{-170, 170}, {-190, 45}, {-210, 66}, {-185, 185}, {-120, 120}, {-350, 350}}};
  for (JointLimits& each : limits) each = {each.least * kDegree, each.most * kDegree};
  return limits;
}

std::vector<Link> PublishedLinkErrors() {
  std::vector<Link> errors = {{0.0206, 0.4539, 0.1428, 0.0074, 0},    {-0.0169, 0, -0.2632, 0.0022, 0.0079},
                              {0.0309, -0.2168, 0.0508, -0.0127, 0},  {-0.0407, 0.0687, 0.0268, 0.0014, 0},
                              {0.0274, -0.0832, -0.0034, -0.0137, 0}, {-0.0237, 0.1041, 0.0378, 0.0293, 0}};
  for (Link& link : errors) {
    link.theta *= kDegree;
    link.alpha *= kDegree;
    link.beta *= kDegree;
  }
  return errors;
}

Eigen::Isometry3d PublishedHandEye() {
  Eigen::Matrix3d printed;
  printed << 0.0171, 0.9998, 0.0053,  //
      0.9999, -0.0173, 0.0022,        //
      0.0003, 0.0056, -1.0001;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(printed, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  pose.translation() << 1.2874, 0.5842, 264.7846;
  return pose;
}

Eigen::Isometry3d DrawnHandEye() {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << 0, 1, 0,  //
      1, 0, 0,               //
      0, 0, -1;
  pose.translation() << 0, 0, 265;
  return pose;
}

}  // namespace scancal
