// A laser line profiler that a robot carries along planes: hand-eye and links together (Lembono, Suarez-Ruiz and Pham,
// SCALAR, arXiv 1803.00747).
#pragma once
#include <ceres/rotation.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <string>
#include <vector>
#include "models/chain/chain.h"
#include "models/line/pseudo_points.h"
#include "models/rotation.h"
#include "solver/model.h"

namespace scancal::robot_profiler {

// A reading (y, z) of a pose, y its depth and z along the line, lies in the base at
//
//     P = base_from_flange(q; links) flange_from_profiler (0, (1 + scale_y) y, (1 + scale_z) z)',
//
// and a target is a plane n . P = d of which nothing is known. The residual is along depth, as the noise is:
//
//     e = (n . P - d) / (n . dP/dy),
//
// affine in (y, z) within a pose, hence exact on the three pseudo-points of its profile. A turn of the base with all
// planes changes nothing. Nor does it matter whether depth grows away from the sensor or towards it: a profile has no
// thickness, and the other sense is the hand-eye's half turn about z.
//
// repeatability moves the flange of a pose and turns it about its own origin; noise_y moves a point along depth.
// Lengths mm, angles rad.
class Model {
 public:
  // Each the first of as many as its name has components; behind the links what the joints do (DeclareJointTerms).
  enum Index {
    kHandEye = 0,
    kScaleY = 6,
    kScaleZ = 7,
    kNormal1 = 8,
    kNormal2 = 9,
    kDistance = 10,
    kRepeatability = 11,
    kNoiseY = 17,
    kLinks = 18
  };
  static constexpr int kRowsPerPoint = 1;
  // kPlane: n . P - d, smooth wherever the profiler looks, for a start from far away.
  enum class Residuals { kDepth, kPlane };

  struct View {  // the profile of a pose
    std::string name = {};
    std::vector<double> joints = {};                                     // rad, one a link
    Eigen::Isometry3d base_from_flange = Eigen::Isometry3d::Identity();  // where links are none
    std::vector<PseudoPoint> points = {};
    double count = 0;                // raw points behind them
    std::vector<double> terms = {};  // JointTermsAt; empty: what the joints do is left out
  };
  struct Target {
    std::string name;
    std::vector<View> views;
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // where normal_1, normal_2 (a rotation vector in e1, e2) start
    double distance = 0;                                // and where distance starts
    Eigen::Vector3d e1 = Eigen::Vector3d::UnitX(), e2 = Eigen::Vector3d::UnitY();
    void SetPlane(const Eigen::Vector3d& unit_normal, double d);
  };

  // Hand-eye estimated from zero, links as SetDefaultLinkRoles says, noise estimated.
  explicit Model(std::vector<Link> links, Residuals residuals = Residuals::kDepth);
  const Quantities& quantities() const { return quantities_; }
  Quantity& quantity(int k) { return quantities_[k]; }
  const std::vector<Link>& links() const { return links_; }
  Model As(Residuals residuals) const;
  int FirstOfJointTerms() const { return kLinks + kLinkNumbers * static_cast<int>(links_.size()); }
  int Points(const View& view) const { return static_cast<int>(view.points.size()); }
  double Count(const View& view) const { return view.count; }

  template <class T>
  void Residual(const Target& plane, const View& pose, const Seen<T>& q, T* r) const;

  // A profile in the base, P = origin + y along_y + z along_z, of values as in Seen.
  template <class T>
  struct InBase {
    T origin[3], along_y[3], along_z[3];
    T arm[3];  // from the flange to origin
  };
  template <class T>
  InBase<T> At(const View& pose, const T* q) const;

 private:
  std::vector<Link> links_;
  std::vector<int> joints_of_terms_;
  Residuals residuals_;
  Quantities quantities_;
};

template <class T>
Model::InBase<T> Model::At(const View& pose, const T* q) const {
  ChainFrame<T> flange = MakeChainFrame<T>(pose.base_from_flange);
  std::vector<T> errors(q + kLinks, q + FirstOfJointTerms());
  AddJointTerms(pose.terms, q + FirstOfJointTerms(), joints_of_terms_, errors.data());
  MoveAlong(links_, pose.joints.data(), errors.data(), &flange);
  T hand[9];  // columns
  ceres::AngleAxisToRotationMatrix(q + kHandEye + 3, hand);
  const auto in_base = [&](const T* v, T* result) {
    for (int i = 0; i < 3; ++i) result[i] = flange.x[i] * v[0] + flange.y[i] * v[1] + flange.z[i] * v[2];
  };
  InBase<T> profile;
  in_base(q + kHandEye, profile.arm);
  in_base(hand + 3, profile.along_y);
  in_base(hand + 6, profile.along_z);
  for (int i = 0; i < 3; ++i) {
    profile.origin[i] = flange.p[i] + q[kRepeatability + i] + profile.arm[i];
    profile.along_y[i] *= 1.0 + q[kScaleY];
    profile.along_z[i] *= 1.0 + q[kScaleZ];
  }
  return profile;
}

template <class T>
void Model::Residual(const Target& plane, const View& pose, const Seen<T>& q, T* r) const {
  const InBase<T> profile = At(pose, q.q);
  T turn[3], n[3], tilted[3];
  for (int i = 0; i < 3; ++i) turn[i] = q[kNormal1] * plane.e1[i] + q[kNormal2] * plane.e2[i];
  Rotate(turn, plane.normal, n);
  const T* tilt = q.q + kRepeatability + 3;  // of the flange: n . (v + tilt x v) = (n + n x tilt) . v
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    tilted[i] = n[i] + n[j] * tilt[k] - n[k] * tilt[j];
  }
  const auto dot = [](const T* a, const T* b) { return T(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]); };
  const T at_origin =
      dot(n, profile.origin) + dot(tilted, profile.arm) - dot(n, profile.arm) - (plane.distance + q[kDistance]);
  const T by_y = dot(tilted, profile.along_y), by_z = dot(tilted, profile.along_z);
  const T scale = residuals_ == Residuals::kDepth ? 1.0 / by_y : T(1.0);
  for (int i = 0; i < Points(pose); ++i) {
    const PseudoPoint& p = pose.points[i];
    r[i] = (p.weight * (at_origin + by_y * p.y + by_z * p.z) - by_y * q(i, kNoiseY)) * scale;
  }
}

}  // namespace scancal::robot_profiler
