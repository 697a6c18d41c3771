// A robot whose flange carries a tool, and a world that stands: points known on the one side are measured from the
// other.
#pragma once
#include <ceres/rotation.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>
#include "models/chain/chain.h"
#include "solver/model.h"

namespace scancal::robot_ball {

// A ball centre c seen in the scanner's frame lies in the base at (Zhou et al. 2025, eq. 1)
//
//     base_from_flange(q; links) flange_from_scanner c = base_from_artifact k,
//
// k its centre on the artifact. The residual is the difference, written in the scanner's frame,
//
//     r = c - scanner_from_base(q) base_from_artifact k:
//
// there lives the noise, and there a turn of the base changes nothing (in the base frame theta_1 looks determined away
// from the solution). A tracker in the world that sees reflectors k of the tool is the same, measured from the other
// side,
//
//     r = c - world_from_base base_from_flange(q; links) flange_from_tool k.
//
// hand_eye_x .. _rz is flange_from_scanner, or flange_from_tool, as a translation and a rotation vector; artifact_x ..
// _rz, one a station, are increments on Target::base_from_artifact (the world is the only station), the turn about its
// origin.
//
// What may be wrong besides, each nominally zero: repeatability moves the flange of a pose and turns it about its own
// origin, and so moves all balls of the pose alike; ball moves one of them by SeenBall::spread times itself;
// sphere_NAME_x, _y, _z is the error of a centre on the artifact; artifact_scale and scanner_scale are relative errors
// of all lengths of the one and the other; drift_x, _y, _z is how far what the scanner shows moves from the first pose
// to the last, in its own frame; expansion is by how much of themselves all d and a grow for each kelvin above the mean
// temperature of the poses; and what the joints do (DeclareJointTerms). Lengths mm, angles rad.
class Model {
 public:
  // Each the first of three or six, x y z rx ry rz, or of one; links: the first of kLinkNumbers a link, behind them
  // what the joints do, then the spheres.
  enum Index {
    kHandEye = 0,
    kArtifact = 6,
    kRepeatability = 12,
    kBall = 18,
    kDrift = 21,
    kArtifactScale = 24,
    kScannerScale = 25,
    kExpansion = 26,
    kLinks = 27
  };
  static constexpr int kRowsPerPoint = 3;

  struct Sphere {  // of the artifact, in its own frame
    std::string name;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  };
  struct SeenBall {
    int sphere = 0;                                        // index
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();      // in the scanner's frame
    Eigen::Matrix3d spread = Eigen::Matrix3d::Identity();  // of its noise, relative to the usual
  };
  struct View {  // a pose of the robot
    std::string name = {};
    std::vector<double> joints = {};                                     // rad, one a link
    Eigen::Isometry3d base_from_flange = Eigen::Isometry3d::Identity();  // where links are none: as the controller says
    std::vector<SeenBall> balls = {};
    int number = 0;                  // in the order in which the poses were taken, from 0
    double time = 0;                 // of all poses, from -1/2 to 1/2
    double warmer = 0;               // K above the mean temperature of all poses; 0 where none was logged
    std::vector<double> terms = {};  // JointTermsAt; empty: what the joints do is left out
  };
  struct Target {  // a station of the artifact
    std::string name;
    std::vector<View> views;
    Eigen::Isometry3d base_from_artifact = Eigen::Isometry3d::Identity();  // where artifact_x .. _rz start
  };

  // Hand-eye estimated from zero; links as SetDefaultLinkRoles says; noise estimated; spheres held; of a single one no
  // turn. measured_in_world: the spheres are on the tool.
  Model(std::vector<Link> links, std::vector<Sphere> spheres, bool measured_in_world = false);
  const Quantities& quantities() const { return quantities_; }
  Quantity& quantity(int k) { return quantities_[k]; }
  const std::vector<Link>& links() const { return links_; }
  const std::vector<Sphere>& spheres() const { return spheres_; }
  int FirstOfJointTerms() const { return kLinks + kLinkNumbers * static_cast<int>(links_.size()); }
  int FirstOfSpheres() const { return FirstOfJointTerms() + static_cast<int>(joints_of_terms_.size()); }
  int Points(const View& view) const { return static_cast<int>(view.balls.size()); }
  double Count(const View& view) const { return 3.0 * Points(view); }
  // A rotation and a translation of k: four balls of a pose that span space (three in a plane) stand for all of them,
  // as exactly as six numbers stand for a profile. Their own centres are zero; the measured ones are the constant.
  std::vector<StandIns<View>> MakeNodes(const Target& station) const;
  Eigen::MatrixXd Interpolate(const std::vector<View>& nodes, const View& pose) const;

  template <class T>
  void Residual(const Target& station, const View& pose, const Seen<T>& q, T* r) const;

 private:
  Eigen::MatrixXd Features(const std::vector<SeenBall>& balls) const;  // 4 x balls: (k, length_)

  std::vector<Link> links_;
  std::vector<int> joints_of_terms_;
  std::vector<Sphere> spheres_;
  bool measured_in_world_;
  double length_ = 1;  // mm, of the artifact: on a par with its coordinates
  Quantities quantities_;
};

using Station = Model::Target;

// The distance of two balls, known from a CMM, seen in some pose each: not used in the calibration (`check:`).
struct CheckLength {
  std::string name;                     // of the pair, for tables
  Model::View first_pose, second_pose;  // one ball each: balls[0]; may be the same pose
  double distance = 0, u = 0;           // mm
};

// What a data set holds once it is read: mm, rad, no files.
struct Measurements {
  std::vector<Link> links;                    // none: the poses of the flange are given
  bool measured_in_world = false;             // the spheres are on the tool, the stations are the world's (one)
  std::optional<Eigen::Isometry3d> hand_eye;  // where all of it is held
  Eigen::Vector3d gravity = -Eigen::Vector3d::UnitZ();  // its direction in the base
  std::vector<double> gear_ratios;                      // Arm
  std::optional<double> temperature;                    // mean of the poses, degC, if it was logged
  std::vector<Model::Sphere> spheres;
  double u_spheres = 0;           // standard uncertainty of each coordinate of their centres, mm
  double ball_diameter = 0;       // mm; 0: not declared
  std::vector<Station> stations;  // base_from_artifact not set
  std::vector<CheckLength> check;
  std::vector<Station> held_out;  // whole poses that take no part; where the artifact is then is found from the balls
  double usual_ball_noise = 0;    // mm: what Model::SeenBall::spread is relative to; 0: nothing was declared

  // A seen point as it lies on the tool, and in the world.
  const Eigen::Vector3d& OnTool(const Model::SeenBall& ball) const {
    return measured_in_world ? spheres[static_cast<size_t>(ball.sphere)].centre : ball.centre;
  }
  const Eigen::Vector3d& InWorld(const Model::SeenBall& ball) const {
    return measured_in_world ? ball.centre : spheres[static_cast<size_t>(ball.sphere)].centre;
  }
};

// Sets time and terms of all poses, calibrated with and held out, each in its own order of numbers.
void SetTerms(Measurements* data);

// What a method finds.
struct Kinematics {
  Eigen::Isometry3d flange_from_scanner = Eigen::Isometry3d::Identity();
  std::vector<Link> link_errors;         // added to the nominal; one a link
  std::vector<double> joint_terms = {};  // of DeclareJointTerms; none: zero
  double expansion = 0;                  // 1/K
};

// flange_from_scanner of hand_eye_x .. _rz, and back; the rotation vector is at most pi long.
Eigen::Isometry3d PoseOf(const Eigen::Matrix<double, 6, 1>& numbers);
Eigen::Matrix<double, 6, 1> NumbersOf(const Eigen::Isometry3d& pose);

template <class T>
void Model::Residual(const Target& station, const View& pose, const Seen<T>& q, T* r) const {
  ChainFrame<T> flange = MakeChainFrame<T>(pose.base_from_flange);
  std::vector<T> errors(q.q + kLinks, q.q + FirstOfJointTerms());
  AddJointTerms(pose.terms, q.q + FirstOfJointTerms(), joints_of_terms_, errors.data());
  if (pose.warmer != 0 && !IsZero(q[kExpansion]))
    for (size_t k = 0; k < links_.size(); ++k) {
      T *d = &errors[kLinkNumbers * k + 1], *a = d + 1;
      *d += (*d + links_[k].d) * q[kExpansion] * pose.warmer;
      *a += (*a + links_[k].a) * q[kExpansion] * pose.warmer;
    }
  MoveAlong(links_, pose.joints.data(), errors.data(), &flange);
  T hand[9], turn[9];  // columns of the rotations
  ceres::AngleAxisToRotationMatrix(q.q + kHandEye + 3, ceres::ColumnMajorAdapter3x3(hand));
  ceres::AngleAxisToRotationMatrix(q.q + kArtifact + 3, ceres::ColumnMajorAdapter3x3(turn));
  const Eigen::Matrix3d& reference = station.base_from_artifact.linear();
  T tool[12], world[12];  // base_from_tool and base_from_artifact: columns x, y, z, p
  for (int c = 0; c < 4; ++c) {
    const T* in_flange = c < 3 ? hand + 3 * c : q.q + kHandEye;
    for (int i = 0; i < 3; ++i)
      tool[3 * c + i] = flange.x[i] * in_flange[0] + flange.y[i] * in_flange[1] + flange.z[i] * in_flange[2];
    for (int i = 0; c < 3 && i < 3; ++i)
      world[3 * c + i] = turn[i] * reference(0, c) + turn[3 + i] * reference(1, c) + turn[6 + i] * reference(2, c);
  }
  for (int i = 0; i < 3; ++i) {
    tool[9 + i] += flange.p[i] + q[kRepeatability + i];
    world[9 + i] = station.base_from_artifact.translation()[i] + q[kArtifact + i];
  }
  const T *known = measured_in_world_ ? tool : world, *measured = measured_in_world_ ? world : tool;
  const T* tilt = q.q + kRepeatability + 3;  // of the flange, along the axes of the base
  const bool is_tilted = !std::all_of(tilt, tilt + 3, IsZero<T>);
  const bool drifts = !std::all_of(q.q + kDrift, q.q + kDrift + 3, IsZero<T>);
  for (int b = 0; b < Points(pose); ++b, r += 3) {
    const SeenBall& seen = pose.balls[b];
    const T* error = q.q + FirstOfSpheres() + 3 * seen.sphere;
    const Eigen::Vector3d& k = spheres_[seen.sphere].centre;
    T on_known[3], offset[3];  // from the origin of the known frame, from that of the measured one; base
    for (int i = 0; i < 3; ++i) on_known[i] = known[i] * k[0] + known[3 + i] * k[1] + known[6 + i] * k[2];
    if (!IsZero(q[kArtifactScale]))
      for (T& x : on_known) x += x * q[kArtifactScale];
    if (!std::all_of(error, error + 3, IsZero<T>))
      for (int i = 0; i < 3; ++i)
        on_known[i] += known[i] * error[0] + known[3 + i] * error[1] + known[6 + i] * error[2];
    for (int i = 0; i < 3; ++i) offset[i] = on_known[i] + known[9 + i] - measured[9 + i];
    if (is_tilted) {
      T arm[3];
      for (int i = 0; i < 3; ++i) arm[i] = on_known[i] + known[9 + i] - flange.p[i];
      for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        offset[i] += tilt[j] * arm[l] - tilt[l] * arm[j];
      }
    }
    const T noise[3] = {q(b, kBall), q(b, kBall + 1), q(b, kBall + 2)};
    const bool has_noise = !std::all_of(noise, noise + 3, IsZero<T>);
    for (int c = 0; c < 3; ++c) {
      r[c] = seen.centre[c] -
             (measured[3 * c] * offset[0] + measured[3 * c + 1] * offset[1] + measured[3 * c + 2] * offset[2]);
      if (drifts) r[c] -= q[kDrift + c] * pose.time;
      if (!IsZero(q[kScannerScale])) r[c] -= q[kScannerScale] * seen.centre[c];
      for (int j = 0; has_noise && j < 3; ++j) r[c] -= seen.spread(c, j) * noise[j];
    }
  }
}

}  // namespace scancal::robot_ball
