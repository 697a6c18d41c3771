// A robot arm as a product of modified Denavit-Hartenberg links.
#pragma once
#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>
#include "solver/model.h"

namespace scancal {

// Hayati's form, eqs. (2)-(4) of Zhou et al. 2025:
//
//     link_i = Rz(q_i + theta_i) Tz(d_i) Tx(a_i) Rx(alpha_i) Ry(beta_i)
//
// Nominal values, or errors of them; mm, rad.
struct Link {
  double theta = 0, d = 0, a = 0, alpha = 0, beta = 0;
};
inline constexpr int kLinkNumbers = 5;  // in the order of Link

// All numbers of all links, kLinkNumbers a link, and back.
Eigen::VectorXd NumbersOf(const std::vector<Link>& links);
std::vector<Link> LinksOf(const Eigen::VectorXd& numbers);

// Nominal links and their errors, added; no errors: as they are.
std::vector<Link> WithErrors(const std::vector<Link>& nominal, const std::vector<Link>& errors);

// A rotation by its columns and a translation, of numbers or of dual numbers.
template <class T>
struct ChainFrame {
  T x[3], y[3], z[3], p[3];
};

template <class T>
ChainFrame<T> MakeChainFrame(const Eigen::Isometry3d& pose) {
  ChainFrame<T> frame;
  for (int i = 0; i < 3; ++i) {
    frame.x[i] = T(pose(i, 0));
    frame.y[i] = T(pose(i, 1));
    frame.z[i] = T(pose(i, 2));
    frame.p[i] = T(pose(i, 3));
  }
  return frame;
}

// Turns columns u and v by the angle about the third: u c + v s, v c - u s.
template <class T, class Angle>
void TurnColumns(const Angle& angle, T u[3], T v[3]) {
  using std::cos, std::sin;
  const Angle c = cos(angle), s = sin(angle);
  for (int i = 0; i < 3; ++i) {
    const T old = u[i];
    u[i] = old * c + v[i] * s;
    v[i] = v[i] * c - old * s;
  }
}

// Few numbers of a chain have a derivative at a time; the others need no dual arithmetic.
template <class T>
void TurnBy(const T& angle, T u[3], T v[3]) {
  if (IsZero(angle)) return;
  if (IsConstant(angle)) {
    TurnColumns(ValueOf(angle), u, v);
  } else {
    TurnColumns(angle, u, v);
  }
}

template <class T>
void Shift(const T axis[3], const T& by, T p[3]) {
  const bool constant = IsConstant(by);
  for (int i = 0; i < 3; ++i) {
    if (constant) {
      p[i] += axis[i] * ValueOf(by);
    } else {
      p[i] += axis[i] * by;
    }
  }
}

// frame := frame * link_1 ... link_n at the joint angles (rad). errors: kLinkNumbers per link, added to the nominal.
template <class T>
void MoveAlong(const std::vector<Link>& links, const double* joints, const T* errors, ChainFrame<T>* frame) {
  for (size_t k = 0; k < links.size(); ++k, errors += kLinkNumbers) {
    const Link& link = links[k];
    TurnBy(T(joints[k] + link.theta + errors[0]), frame->x, frame->y);
    Shift(frame->z, T(link.d + errors[1]), frame->p);
    Shift(frame->x, T(link.a + errors[2]), frame->p);
    TurnBy(T(link.alpha + errors[3]), frame->y, frame->z);
    TurnBy(T(link.beta + errors[4]), frame->z, frame->x);
  }
}

// What a joint does besides turning by what it reads, each nominally zero. Added to q_i (and so to theta_i):
//
//     gravity_i_k          sags under a mass at the end of link k: times z_i . ((p_k - o_i) x g) / reach, the moment of
//                          its weight about axis i, 1 where it hangs out by the whole reach; rad
//     backlash_i           lags behind the way it came: times the sign of its last move, half the dead band; rad
//     joint_scale_i        counts of a turn: times q_i; 1
//     eccentricity_cos1_i  .. _sin1_i, _cos2_i, _sin2_i: of gear and encoder, once and twice a turn: times cos q_i,
//                          sin q_i, cos 2 q_i, sin 2 q_i; rad
//     motor_cos_i          _sin_i: of the motor, once in each of its turns: times cos(ratio q_i), sin(ratio q_i); rad
//
// (Whitney, Lozinski and Rourke, J. Dyn. Syst. Meas. Control 108, 1986, 1; Judd and Knasinski, IEEE Trans. Robot.
// Autom. 6, 1990, 20.) All are linear: JointTermsAt says what each is multiplied by in a pose. The moments are those of
// the nominal links: what their errors change is of second order.
constexpr int CountOfJointTerms(int links) { return links * (links + 1) / 2 + 8 * links; }

// Appends them, all held at zero, a kind after the other, a source of the budget per kind and joint ("gravity_2").
void DeclareJointTerms(size_t links, Quantities* quantities);

// d q_i / d term, in that order. direction: of each joint's last move, +1, -1, or 0 where nobody knows. gravity: its
// direction in the base, a unit vector. gear_ratios: turns of each motor for one of its joint; 0, or none at all: not
// known.
std::vector<double> JointTermsAt(const std::vector<Link>& links, const std::vector<double>& joints,
                                 const std::vector<int>& direction, const Eigen::Vector3d& gravity,
                                 const std::vector<double>& gear_ratios = {});

// Sign of each joint's last move, of poses in the order in which they were taken; a joint that stood still keeps the
// sign of its move before.
std::vector<std::vector<int>> DirectionsOf(const std::vector<const std::vector<double>*>& joints);

// Sets the terms of poses (views with joints and terms) that were taken in this order.
template <class View>
void SetTermsInOrder(const std::vector<Link>& links, const Eigen::Vector3d& gravity,
                     const std::vector<double>& gear_ratios, const std::vector<View*>& poses) {
  std::vector<const std::vector<double>*> joints;
  for (const View* pose : poses) joints.push_back(&pose->joints);
  const std::vector<std::vector<int>> directions = DirectionsOf(joints);
  for (size_t p = 0; p < poses.size(); ++p)
    poses[p]->terms = JointTermsAt(links, poses[p]->joints, directions[p], gravity, gear_ratios);
}

// The joint that each term turns.
std::vector<int> JointsOfTerms(int links);

// errors: kLinkNumbers a link; adds to its thetas what the terms (values as in DeclareJointTerms) make of a pose. at:
// JointTermsAt of it, or empty: nothing is added.
template <class T>
void AddJointTerms(const std::vector<double>& at, const T* terms, const std::vector<int>& joints, T* errors) {
  for (size_t k = 0; k < joints.size() && !at.empty(); ++k)
    if (at[k] != 0 && !IsZero(terms[k])) errors[kLinkNumbers * joints[k]] += at[k] * terms[k];
}

// joints with what the terms make of the pose, rad. at, terms: as for AddJointTerms; either may be empty.
std::vector<double> TurnedJoints(std::vector<double> joints, const std::vector<double>& at,
                                 const std::vector<double>& terms);

// Of the terms that are estimated without a prior, holds those that the data do not tell from the others; returns their
// names. first, count: of the terms; at: where the fit starts, which then is one of the smaller problem.
std::vector<std::string> HoldUndeterminedTerms(int first, int count, Problem* problem, Estimate* at);

// The flange at the joint angles (rad, one per link), links as they are.
Eigen::Isometry3d BaseFromFlange(const std::vector<Link>& links, const std::vector<double>& joints);

// Appends theta_1 .. beta_n, errors of the links, all held at zero, in the order that MoveAlong takes.
void DeclareLinks(size_t links, Quantities* quantities);

// Whether the axis of the next joint is nominally parallel to this link's: then d of this link and of the next one
// cannot be told apart, and a small turn of that axis is beta.
bool NextAxisIsParallel(const Link& link);

// The roles of a robot whose end carries something whose pose is estimated as well: theta_1 and d_1 are the base's, all
// of the last link is the tool's, d before a parallel axis is the next d; beta is estimated there and held elsewhere.
// Of six revolute joints that leaves 18, and with a hand-eye of six numbers the 24 = 4 x 6 + 6 - 6 that data without a
// fixed base can determine. first: index of theta_1. Estimated ones have no prior.
void SetDefaultLinkRoles(const std::vector<Link>& links, int first, Quantities* quantities);

}  // namespace scancal
