// A scanner on a robot's flange that sees the balls of an artifact (Zhou et al. 2025).
#pragma once
#include <ceres/rotation.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <string>
#include <vector>
#include "models/chain/chain.h"
#include "solver/model.h"

namespace scancal::robot_ball {

// A ball centre c seen in the scanner's frame lies in the base at (eq. 1)
//
//     base_from_flange(q; links) flange_from_scanner c = base_from_artifact k,
//
// k its centre on the artifact. The residual is the difference, written in the scanner's frame,
//
//     r = c - scanner_from_base(q) base_from_artifact k:
//
// there lives the noise, and there a turn of the base changes nothing (in the base frame theta_1 looks determined away
// from the solution). hand_eye_x .. _rz is flange_from_scanner as a translation and a rotation vector; artifact_x ..
// _rz, one a station, are increments on Target::base_from_artifact, the turn about the artifact's origin.
//
// What may be wrong besides, each nominally zero: repeatability moves all balls of a pose alike, ball moves one of them
// by SeenBall::spread times itself, sphere_NAME_x, _y, _z is the error of a centre on the artifact. Lengths mm, angles
// rad.
class Model {
 public:
  // Each the first of three or six, x y z rx ry rz; links: the first of kLinkNumbers a link.
  enum Index { kHandEye = 0, kArtifact = 6, kRepeatability = 12, kBall = 15, kLinks = 18 };
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
  };
  struct Target {  // a station of the artifact
    std::string name;
    std::vector<View> views;
    Eigen::Isometry3d base_from_artifact = Eigen::Isometry3d::Identity();  // where artifact_x .. _rz start
  };

  // Hand-eye estimated from zero; links as SetDefaultLinkRoles says; noise estimated; spheres held.
  Model(std::vector<Link> links, std::vector<Sphere> spheres);
  const Quantities& quantities() const { return quantities_; }
  Quantity& quantity(int k) { return quantities_[k]; }
  const std::vector<Link>& links() const { return links_; }
  const std::vector<Sphere>& spheres() const { return spheres_; }
  int FirstOfSpheres() const { return kLinks + kLinkNumbers * static_cast<int>(links_.size()); }
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
  std::vector<Sphere> spheres_;
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
  std::vector<Link> links;  // none: the poses of the flange are given
  std::vector<Model::Sphere> spheres;
  double u_spheres = 0;           // standard uncertainty of each coordinate of their centres, mm
  double ball_diameter = 0;       // mm; 0: not declared
  std::vector<Station> stations;  // base_from_artifact not set
  std::vector<CheckLength> check;
  double usual_ball_noise = 0;  // mm: what Model::SeenBall::spread is relative to; 0: nothing was declared
};

// What a method finds.
struct Kinematics {
  Eigen::Isometry3d flange_from_scanner = Eigen::Isometry3d::Identity();
  std::vector<Link> link_errors;  // added to the nominal; one a link
};

// flange_from_scanner of hand_eye_x .. _rz, and back; the rotation vector is at most pi long.
Eigen::Isometry3d PoseOf(const Eigen::Matrix<double, 6, 1>& numbers);
Eigen::Matrix<double, 6, 1> NumbersOf(const Eigen::Isometry3d& pose);

template <class T>
void Model::Residual(const Target& station, const View& pose, const Seen<T>& q, T* r) const {
  ChainFrame<T> flange = MakeChainFrame<T>(pose.base_from_flange);
  MoveAlong(links_, pose.joints.data(), q.q + kLinks, &flange);
  T hand[9], turn[9];  // columns of the rotations
  ceres::AngleAxisToRotationMatrix(q.q + kHandEye + 3, ceres::ColumnMajorAdapter3x3(hand));
  ceres::AngleAxisToRotationMatrix(q.q + kArtifact + 3, ceres::ColumnMajorAdapter3x3(turn));
  T scanner[12];  // base_from_scanner: columns x, y, z, p
  for (int c = 0; c < 4; ++c) {
    const T* in_flange = c < 3 ? hand + 3 * c : q.q + kHandEye;
    for (int i = 0; i < 3; ++i)
      scanner[3 * c + i] = flange.x[i] * in_flange[0] + flange.y[i] * in_flange[1] + flange.z[i] * in_flange[2];
  }
  for (int i = 0; i < 3; ++i) scanner[9 + i] += flange.p[i] + q[kRepeatability + i];
  for (int b = 0; b < Points(pose); ++b, r += 3) {
    const SeenBall& seen = pose.balls[b];
    const T* error = q.q + FirstOfSpheres() + 3 * seen.sphere;
    const Eigen::Vector3d& k = spheres_[seen.sphere].centre;
    const Eigen::Matrix3d& reference = station.base_from_artifact.linear();
    const Eigen::Vector3d nominal = reference * k;
    T from_scanner[3];  // base
    for (int i = 0; i < 3; ++i)
      from_scanner[i] = turn[i] * nominal[0] + turn[3 + i] * nominal[1] + turn[6 + i] * nominal[2] +
                        station.base_from_artifact.translation()[i] + q[kArtifact + i] - scanner[9 + i];
    if (!std::all_of(error, error + 3, IsZero<T>)) {
      T along[3];
      for (int i = 0; i < 3; ++i)
        along[i] = reference(i, 0) * error[0] + reference(i, 1) * error[1] + reference(i, 2) * error[2];
      for (int i = 0; i < 3; ++i)
        from_scanner[i] += turn[i] * along[0] + turn[3 + i] * along[1] + turn[6 + i] * along[2];
    }
    const T noise[3] = {q(b, kBall), q(b, kBall + 1), q(b, kBall + 2)};
    const bool has_noise = !std::all_of(noise, noise + 3, IsZero<T>);
    for (int c = 0; c < 3; ++c) {
      r[c] = seen.centre[c] - (scanner[3 * c] * from_scanner[0] + scanner[3 * c + 1] * from_scanner[1] +
                               scanner[3 * c + 2] * from_scanner[2]);
      for (int j = 0; has_noise && j < 3; ++j) r[c] -= seen.spread(c, j) * noise[j];
    }
  }
}

}  // namespace scancal::robot_ball
