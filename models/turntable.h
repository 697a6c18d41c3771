// A laser line profiler that turns about an axis and sees planes (Zhao et al. 2021).
#pragma once
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>
#include "models/parts/pseudo_points.h"
#include "models/rotation.h"
#include "models/turntable/form_modes.h"
#include "solver/model.h"

namespace scancal {

// A point (0, y, z) of the profile at encoder angle alpha lies in the table frame at
//
//     P(alpha; y, z) = Rz(-alpha) Rz(pi) ( Ry(tilt_y) Rx(tilt_x) (0, y, z)' + (-M, N, 0)' ),
//
// which for zero tilts is eq. (7), simplified: x = M cos a - (N + y) sin a, y = -M sin a - (N + y) cos a, z = z. A
// placement of the plate is the plane n . P = d. Two residuals, both affine in (y, z) within a profile, hence exact on
// its pseudo-points:
//
//     point to plane   r = n . P - d                     the published kind; biased, because the noise is not along n
//     depth            e = r / (n . dP/dy)               measured depth minus the depth that the model predicts
//
// For a lidar the noise lies along the range: e = r / (n . dP/drange), with dP/drange taken at the profile's own line
// (see Profile::along_range). Lengths mm, angles rad.
//
// What may be wrong besides, each nominally zero: the encoder reads alpha + encoder_cos1 cos alpha + encoder_sin1 sin
// alpha + encoder_cos2 cos 2 alpha + encoder_sin2 sin 2 alpha + encoder_jitter (one a profile); depth is
// y (1 + scale_y) + shear z + linearity eta^2, eta from -1 to 1 over the depths of all scans; z (1 + scale_z); M and N
// grow by expansion; the plate's form adds its modes (form_modes.h) to the distance; noise_y, noise_z move single
// points, line_offset and line_slope all points of a profile along depth, as noise does that is correlated along the
// line.
class Turntable {
 public:
  enum Index {
    kM,
    kN,
    kTiltX,
    kTiltY,
    kScaleY,
    kScaleZ,
    kShear,
    kLinearity,
    kEncoderCos1,
    kEncoderSin1,
    kEncoderCos2,
    kEncoderSin2,
    kExpansion,
    kNormal1,
    kNormal2,
    kDistance,
    kEncoderJitter,
    kLineOffset,
    kLineSlope,
    kNoiseY,
    kNoiseZ,
    kForm  // the first of kFormModes
  };
  enum class Residuals { kPlane, kDepth };
  static constexpr int kRowsPerPoint = 1;

  struct View {  // a profile
    double alpha = 0;
    std::vector<PseudoPoint> points;
    double count = 0;  // raw points behind them
    // A lidar's rows are multiplied by the range at the profile's own line, so that n . dP/drange = -(n . O - d) /
    // range, O the origin of the sensor, divides all of them alike.
    bool along_range = false;
    // Per point, times its weight (smooth_columns.h); empty: none.
    Eigen::MatrixXd form = {};  // the modes of the plate's form, points x kFormModes
    Eigen::VectorXd bend = {};  // eta^2
    Eigen::MatrixXd line = {};  // points x 2: of line_offset and line_slope
  };
  struct Target {  // a placement
    std::string name;
    std::vector<View> views;
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // where normal_1, normal_2 (a rotation vector in e1, e2) start
    double distance = 0;                                // and where distance starts
    Eigen::Vector3d e1 = Eigen::Vector3d::UnitX(), e2 = Eigen::Vector3d::UnitY();
  };

  explicit Turntable(Residuals residuals);
  const Quantities& quantities() const { return quantities_; }
  Quantity& quantity(int k) { return quantities_[k]; }
  Residuals residuals() const { return residuals_; }
  int Points(const View& view) const { return static_cast<int>(view.points.size()); }
  double Count(const View& view) const { return view.count; }

  template <class T>
  void Residual(const Target& plane, const View& profile, const Seen<T>& q, T* r) const;

  // The node storey: point-to-plane residuals are linear in the nine features {1, y, z} x {1, cos a, sin a}, so nine
  // points in general position, three on each of three profiles, give all others. None for the depth residual, nor
  // without a sweep.
  std::vector<StandIns<View>> MakeNodes(const Target& target) const;
  Eigen::MatrixXd Interpolate(const std::vector<View>& nodes, const View& view) const;

  // The unit normal and distance of a placement at its estimated normal_1, normal_2, distance.
  static std::pair<Eigen::Vector3d, double> Plane(const Target& plane, const Eigen::Vector3d& own);
  static void SetPlane(const Eigen::Vector3d& normal, double distance, Target* target);  // n, d and the tangents

  // What the encoder reads beyond the true angle, rad.
  template <class T>
  static T EncoderError(double alpha, const Seen<T>& q);

 private:
  Residuals residuals_;
  Quantities quantities_;
};

// Where the profiler stands: what turns a measured point into the table frame.
struct TurntablePose {
  double M = 0, N = 0, tilt_x = 0, tilt_y = 0, scale_y = 0, scale_z = 0;
  static TurntablePose Of(const std::vector<double>& values);  // one per quantity of Turntable
  // P = table_from_sensor (0, y, z), one for all points of a profile; scales included.
  Eigen::Affine3d TableFromSensor(double alpha) const;
  Eigen::Vector3d Point(double alpha, double y, double z) const {
    return TableFromSensor(alpha) * Eigen::Vector3d(0, y, z);
  }
};

template <class T>
void Turntable::Residual(const Target& plane, const View& profile, const Seen<T>& q, T* r) const {
  using std::cos, std::sin;
  const T turn[3] = {q[kNormal1] * plane.e1[0] + q[kNormal2] * plane.e2[0],
                     q[kNormal1] * plane.e1[1] + q[kNormal2] * plane.e2[1],
                     q[kNormal1] * plane.e1[2] + q[kNormal2] * plane.e2[2]};
  T n[3];
  Rotate(turn, plane.normal, n);
  const T a = profile.alpha - EncoderError(profile.alpha, q);
  const T c = cos(a), s = sin(a);
  // m: n as seen by the untilted profiler, (Rz(-a) Rz(pi))' n; then each coordinate's share of n . P.
  const T m[3] = {-(c * n[0] - s * n[1]), -(s * n[0] + c * n[1]), n[2]};
  const T cx = cos(q[kTiltX]), sx = sin(q[kTiltX]), cy = cos(q[kTiltY]), sy = sin(q[kTiltY]);
  const T by = m[0] * (sy * sx) + m[1] * cx + m[2] * (cy * sx);
  const T bz = m[0] * (sy * cx) - m[1] * sx + m[2] * (cy * cx);
  const T b0 = (m[1] * q[kN] - m[0] * q[kM]) * (1.0 + q[kExpansion]) - (plane.distance + q[kDistance]);
  // n . dP/dnoise of a row of weight one. With the scale, or the noise itself would prefer a small one.
  const T along_noise = profile.along_range ? -b0 : by * (1.0 + q[kScaleY]);
  const T scale = residuals_ == Residuals::kDepth ? 1.0 / along_noise : T(1.0);
  const bool has_form = profile.form.size() && !std::all_of(q.q + kForm, q.q + kForm + kFormModes, IsZero<T>);
  for (int i = 0; i < Points(profile); ++i) {
    const PseudoPoint& p = profile.points[i];
    const T y = p.y * (1.0 + q[kScaleY]) + p.z * q[kShear];
    const T distance = b0 + by * y + bz * (p.z * (1.0 + q[kScaleZ]));
    T noise = q(i, kNoiseY);
    if (profile.line.size()) noise += profile.line(i, 0) * q[kLineOffset] + profile.line(i, 1) * q[kLineSlope];
    r[i] = p.weight * distance - along_noise * noise - bz * q(i, kNoiseZ);
    if (profile.bend.size()) r[i] += (by * profile.bend[i]) * q[kLinearity];
    if (has_form)
      for (int k = 0; k < kFormModes; ++k) r[i] -= profile.form(i, k) * q[kForm + k];
    r[i] *= scale;
  }
}

template <class T>
T Turntable::EncoderError(double alpha, const Seen<T>& q) {
  return q[kEncoderJitter] + std::cos(alpha) * q[kEncoderCos1] + std::sin(alpha) * q[kEncoderSin1] +
         std::cos(2 * alpha) * q[kEncoderCos2] + std::sin(2 * alpha) * q[kEncoderSin2];
}

}  // namespace scancal
