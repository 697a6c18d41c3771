// A ball on a robot's flange that is seated in two sockets of a tool.
#pragma once
#include <ceres/rotation.h>
#include <Eigen/Core>
#include <cmath>
#include <string>
#include <vector>
#include "models/chain/chain.h"
#include "solver/model.h"

namespace scancal::flange_ball {

// The ball rests in socket s (0 or 1) of a tool that lies somewhere in the base:
//
//     r = Rz(-theta_1) (base_from_flange(q; links) ball - (socket + s spacing direction)) nominal spacing / spacing.
//
// A target is one location of the tool: socket_x, _y, _z, where its socket 0 holds the ball, is the target's own, and
// so are direction_1 and _2, small turns of Target::direction about two axes across it. ball_x, _y, _z lies in the
// flange's frame. spacing is the one length that is known; its value must not be zero.
//
// What no tool tells: theta_1 and d_1, which move all tools, the last link, which the ball takes, and how large all of
// it is. Turned back by theta_1 and in units of the spacing the residual does not change with them at all. In plain
// coordinates of the base what is left of it would seem to determine theta_1, and it would shrink with the robot: the
// ball fits best into one of no size.
//
// Noise: seat moves the ball, joint_1 .. joint_n the joints of one pose. What the joints do besides: DeclareJointTerms.
// Lengths mm, angles rad.
class Model {
 public:
  // Each the first of as many as its name has components; links: kLinkNumbers a link, behind them joint_1 .. joint_n,
  // and the terms of the joints.
  enum Index { kBall = 0, kSpacing = 3, kSocket = 4, kDirection = 7, kSeat = 9, kLinks = 12 };
  static constexpr int kRowsPerPoint = 3;

  struct View {  // a pose of the robot
    std::vector<double> joints;
    int socket = 0;
    std::vector<double> terms = {};  // JointTermsAt; empty: what the joints do is left out
  };
  struct Target {  // NOLINT(bugprone-reserved-identifier): of the copy of an array that clang makes
    std::string name;
    std::vector<View> views;
    Eigen::Vector3d direction =
        Eigen::Vector3d::UnitX();  // from socket 0 to socket 1, base: where direction_1, _2 start
    Eigen::Vector3d across[2] = {Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};  // their axes
  };

  // Links as SetDefaultLinkRoles says; seat estimated, joints held.
  explicit Model(std::vector<Link> links);
  const Quantities& quantities() const { return quantities_; }
  Quantity& quantity(int k) { return quantities_[k]; }
  const std::vector<Link>& links() const { return links_; }
  int FirstOfJoints() const { return kLinks + kLinkNumbers * static_cast<int>(links_.size()); }
  int FirstOfJointTerms() const { return FirstOfJoints() + static_cast<int>(links_.size()); }
  int Points(const View&) const { return 1; }
  double Count(const View&) const { return kRowsPerPoint; }
  static void SetDirection(const Eigen::Vector3d& direction, Target* target);  // of any length but zero

  template <class T>
  void Residual(const Target& tool, const View& pose, const Seen<T>& q, T* r) const;

 private:
  std::vector<Link> links_;
  std::vector<int> joints_of_terms_;
  Quantities quantities_;
};

template <class T>
void Model::Residual(const Target& tool, const View& pose, const Seen<T>& q, T* r) const {
  using std::cos, std::sin;
  std::vector<T> errors(q.q + kLinks, q.q + FirstOfJoints());
  for (size_t k = 0; k < links_.size(); ++k) errors[kLinkNumbers * k] += q[FirstOfJoints() + static_cast<int>(k)];
  AddJointTerms(pose.terms, q.q + FirstOfJointTerms(), joints_of_terms_, errors.data());
  ChainFrame<T> flange = MakeChainFrame<T>(Eigen::Isometry3d::Identity());
  MoveAlong(links_, pose.joints.data(), errors.data(), &flange);
  T turn[3], along[3], direction[3], apart[3];
  for (int i = 0; i < 3; ++i) {
    turn[i] = q[kDirection] * tool.across[0][i] + q[kDirection + 1] * tool.across[1][i];
    direction[i] = T(tool.direction[i]);
  }
  ceres::AngleAxisRotatePoint(turn, direction, along);
  for (int i = 0; i < 3; ++i) {
    apart[i] =
        flange.p[i] + flange.x[i] * q[kBall] + flange.y[i] * q[kBall + 1] + flange.z[i] * q[kBall + 2] - q[kSocket + i];
    if (pose.socket == 1) apart[i] -= along[i] * q[kSpacing];
  }
  const T size = quantities_[kSpacing].value / q[kSpacing];
  const T c = size * cos(q[kLinks]), s = size * sin(q[kLinks]);  // of theta_1
  r[0] = c * apart[0] + s * apart[1] - q(0, kSeat);
  r[1] = c * apart[1] - s * apart[0] - q(0, kSeat + 1);
  r[2] = size * apart[2] - q(0, kSeat + 2);
}

}  // namespace scancal::flange_ball
