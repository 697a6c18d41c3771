// A laser line profiler that turns about an axis and sees planes (Zhao et al. 2021).
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>
#include "models/line/pseudo_points.h"
#include "models/rotation.h"
#include "solver/model.h"

namespace scancal::turntable {

// The form of a plate that is not quite flat, as a few smooth modes: orthonormal Legendre products of total degree 2 to
// 4 over [-1, 1]^2, each times its share of the whole, together a mean square of one: amplitudes of standard deviation
// u then are a form of u rms. Lower degrees are the plane itself. A plate bends alike per mm in all directions, so
// where the rectangle is `aspect` times as long in u as in v the variance of degrees (i, j) falls as (i + aspect j)^-4;
// over a square as (total degree)^-4.
inline constexpr int kFormModes = 12;
using FormModes = std::array<double, kFormModes>;
FormModes FormModesAt(double u, double v, double aspect);  // u, v outside the square are taken at its edge

// A reading (alpha; y, z) lies in the table frame at P, see ProfileInTable. A placement of the plate is the plane
// n . P = d. Two residuals, both affine in (y, z) within a profile, hence exact on its pseudo-points:
//
//     point to plane   r = n . P - d                     the published kind; biased, because the noise is not along n
//     depth            e = r / (n . dP/dy)               measured depth minus the depth that the model predicts
//
// For a lidar the noise lies along the range: e = r / (n . dP/drange), with dP/drange taken at the profile's own line
// (see View::along_range). Lengths mm, angles rad.
//
// Besides the quantities of the system, which P knows: the plate's form adds its modes to the distance;
// encoder_jitter turns a profile, and so do backlash and latency by the way the table moves; run-out and wobble of the
// axis add sines of the angle to M, N and the tilts; line_offset and line_slope move all points of a profile along
// depth, as noise does that is correlated along the line, and so does a drift with time; noise_y, noise_z move single
// points.
class Model {
 public:
  static constexpr int kRunOuts = 8;  // cos a, sin a, cos 2a, sin 2a of the one, then of the other
  static constexpr int kDrifts = 4;
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
    kLinearity3,
    kLensZ2,
    kLensYZ,
    kLensYZ2,
    kRangeOffset,
    kRangeScale,
    kEncoderScale,
    kNormal1,  // the first that is not the system's
    kNormal2,
    kDistance,
    kEncoderJitter,
    kBacklash,
    kLatency,
    kRunOut,                           // the first of kRunOuts: of M, then of N
    kWobble = kRunOut + kRunOuts,      // the first of as many: of tilt_x, then of tilt_y
    kLineOffset = kWobble + kRunOuts,  // the first that moves no profile as a whole
    kLineSlope,
    kNoiseY,
    kNoiseZ,
    kDriftSweep,  // the first of kDrifts
    kDrift,
    kWarmUp,
    kDriftTemperature,
    kForm  // the first of kFormModes
  };
  // Errors of depth that curve over the field of view, each with its shape: see System::Shapes.
  static constexpr std::array<Index, 5> kBends = {kLinearity, kLinearity3, kLensZ2, kLensYZ, kLensYZ2};

  enum class Residuals { kPlane, kDepth };
  static constexpr int kRowsPerPoint = 1;

  struct Motion {                           // of a profile
    double direction = 0;                   // 1: the angle grows, -1: it falls
    double speed = 0;                       // of the angle, over the usual one of the sweep
    std::array<double, kDrifts> elapsed{};  // of each kind of drift
  };
  struct View {  // a profile
    double alpha = 0;
    std::vector<PseudoPoint> points;
    double count = 0;  // raw points behind them
    // A lidar's rows are multiplied by the range at the profile's own line, so that n . dP/drange = -(n . O - d) /
    // range, O the origin of the sensor, divides all of them alike.
    bool along_range = false;
    // Per point, times its weight (see AddForm, AddBend); empty: none.
    Eigen::MatrixXd form = {};  // the modes of the plate's form, points x kFormModes
    Eigen::MatrixXd bend = {};  // points x kBends.size(): the shapes
    Eigen::MatrixXd line = {};  // points x 2: of line_offset and line_slope
    Motion motion = {};
  };
  struct Target {  // a placement
    std::string name;
    std::vector<View> views;
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // where normal_1, normal_2 (a rotation vector in e1, e2) start
    double distance = 0;                                // and where distance starts
    Eigen::Vector3d e1 = Eigen::Vector3d::UnitX(), e2 = Eigen::Vector3d::UnitY();
  };

  explicit Model(Residuals residuals);
  const Quantities& quantities() const { return quantities_; }
  Quantity& quantity(int k) { return quantities_[k]; }
  Residuals residuals() const { return residuals_; }
  int Points(const View& view) const { return static_cast<int>(view.points.size()); }
  double Count(const View& view) const { return view.count; }

  template <class T>
  void Residual(const Target& plane, const View& profile, const Seen<T>& q, T* r) const;
  // The same with its derivatives, see HasJacobian.
  void Jacobian(const Target& plane, std::span<const View> profiles, const Seen<double>& q, std::span<const int> seeds,
                double* r, double* jacobian) const;

  // The node storey: point-to-plane residuals are linear in the nine features {1, y, z} x {1, cos a, sin a}, so nine
  // points in general position, three on each of three profiles, give all others. None for the depth residual, nor
  // without a sweep.
  std::vector<StandIns<View>> MakeNodes(const Target& target) const;
  Eigen::MatrixXd Interpolate(const std::vector<View>& nodes, const View& view) const;

  // The unit normal and distance of a placement at its estimated normal_1, normal_2, distance.
  static std::pair<Eigen::Vector3d, double> Plane(const Target& plane, const Eigen::Vector3d& own);
  static void SetPlane(const Eigen::Vector3d& normal, double distance, Target* target);  // n, d and the tangents

 private:
  Residuals residuals_;
  Quantities quantities_;
};

// The only map from readings and the quantities of the system to the table frame, for all points of one profile:
//
//     P(alpha; y, z) = Rz(-a) Rz(pi) ( Ry(tilt_y) Rx(tilt_x) (0, true y, true z)' + (1 + expansion) (-M, N, 0)' )
//
//     a      = alpha - encoder_cos1 cos alpha - encoder_sin1 sin alpha - encoder_cos2 cos 2 alpha
//                    - encoder_sin2 sin 2 alpha - encoder_scale alpha - encoder_jitter
//                    - backlash direction / 2 - latency speed
//     true y = (1 + scale_y + range_scale) y + shear z + bend,    true z = (1 + scale_z + range_scale) z
//
// and M, N, tilt_x, tilt_y each with its run-out or wobble, sum of r_1 cos alpha + r_2 sin alpha + r_3 cos 2 alpha +
// r_4 sin 2 alpha. bend (mm) is the sum of the quantities Model::kBends times their shapes: of a point System::Bend, of
// a pseudo-point what its profile says (View::bend). A lidar's range_offset adds to the range. With M and N alone this
// is eq. (7), simplified: x = M cos a - (N + y) sin a, y = -M sin a - (N + y) cos a, z = z. P is affine in (y, z,
// bend); the columns are kept as they lie before the table turns, because the normal of a plane is turned back once and
// then needs only products with them. mm, rad.
template <class T>
struct ProfileInTable {
  using Vector = Eigen::Matrix<T, 3, 1>;

  // q: by Model::Index.
  ProfileInTable(double alpha, const T* q, const Model::Motion& motion = {});
  void TurnTo(double alpha, const T* q, const Model::Motion& motion = {});  // another profile of the same system

  Vector Turned(const Vector& v) const { return {-(c * v[0] + s * v[1]), s * v[0] - c * v[1], v[2]}; }
  Vector TurnedBack(const Vector& v) const { return {-(c * v[0] - s * v[1]), -(s * v[0] + c * v[1]), v[2]}; }
  Vector Point(double y, double z, double bend) const {
    return Turned(origin + along_y * T(y) + along_z * T(z) + along_depth * T(bend));
  }
  void SetMount(const std::array<T, 4>& mount, const T* q);  // M, N, tilt_x, tilt_y of this profile

  T c, s;         // cosine and sine of a
  Vector origin;  // the profiler's zero
  Vector along_y, along_z, along_depth;
  T cx, sx, cy, sy;  // of the tilts
  bool runs_out;     // the mount is another in every profile
};

// cos alpha, sin alpha, cos 2 alpha, sin 2 alpha.
inline double Harmonic(int k, double alpha) {
  const double angle = k < 2 ? alpha : 2 * alpha;
  return k % 2 == 0 ? std::cos(angle) : std::sin(angle);
}

// A number for each quantity of the system: as declared, as found, as it is in a simulation.
struct System {
  static constexpr size_t kQuantities = Model::kNormal1;
  std::array<double, kQuantities> q{};  // by Model::Index
  // Over which eta (of y) and zeta (of z) run from -1 to 1, mm; of no consequence without Model::kBends.
  std::array<double, 2> depths{}, heights{};

  double operator[](size_t k) const { return q[k]; }
  double& operator[](size_t k) { return q[k]; }
  double M() const { return q[Model::kM]; }
  double N() const { return q[Model::kN]; }
  System With(double M, double N) const;  // everything else as it is

  std::array<double, Model::kBends.size()> Shapes(double y,
                                                  double z) const;  // eta^2, eta^3, zeta^2, eta zeta, eta zeta^2
  double Bend(double y, double z) const;                            // mm
  bool Bends() const;                                               // any of it is not zero
  ProfileInTable<double> At(double alpha) const;                    // a profile without jitter
  Eigen::Vector3d Point(double alpha, double y, double z) const;
  struct Derivatives {
    Eigen::Vector3d point;
    Eigen::Matrix<double, 3, kQuantities> by;
  };
  Derivatives Differentiate(double alpha, double y, double z) const;
};

template <class T>
void ProfileInTable<T>::TurnTo(double alpha, const T* q, const Model::Motion& motion) {
  using std::cos, std::sin;
  T a = alpha - q[Model::kEncoderJitter];
  if (!IsZero(q[Model::kEncoderScale])) a -= alpha * q[Model::kEncoderScale];
  if (motion.direction != 0) a -= motion.direction / 2 * q[Model::kBacklash];
  if (motion.speed != 0) a -= motion.speed * q[Model::kLatency];
  if (!std::all_of(q + Model::kEncoderCos1, q + Model::kEncoderSin2 + 1, IsZero<T>))
    a -= cos(alpha) * q[Model::kEncoderCos1] + sin(alpha) * q[Model::kEncoderSin1] +
         cos(2 * alpha) * q[Model::kEncoderCos2] + sin(2 * alpha) * q[Model::kEncoderSin2];
  c = cos(a);
  s = sin(a);
  if (!runs_out) return;
  std::array<T, 4> mount = {q[Model::kM], q[Model::kN], q[Model::kTiltX], q[Model::kTiltY]};
  for (size_t k = 0; k < 2 * Model::kRunOuts; ++k)
    mount[k / 4] += Harmonic(static_cast<int>(k % 4), alpha) * q[Model::kRunOut + k];
  SetMount(mount, q);
}

template <class T>
void ProfileInTable<T>::SetMount(const std::array<T, 4>& mount, const T* q) {
  using std::cos, std::sin;
  const T growth = 1.0 + q[Model::kExpansion];
  origin = {-mount[0] * growth, mount[1] * growth, T(0.0)};
  cx = cos(mount[2]);
  sx = sin(mount[2]);
  cy = cos(mount[3]);
  sy = sin(mount[3]);
  along_depth = {sy * sx, cx, cy * sx};
  const Vector height = {sy * cx, -sx, cy * cx};
  for (int i = 0; i < 3; ++i) {
    along_y[i] = along_depth[i] * (1.0 + q[Model::kScaleY] + q[Model::kRangeScale]);
    along_z[i] = height[i] * (1.0 + q[Model::kScaleZ] + q[Model::kRangeScale]) + along_depth[i] * q[Model::kShear];
  }
}

template <class T>
ProfileInTable<T>::ProfileInTable(double alpha, const T* q, const Model::Motion& motion)
    : runs_out(!std::all_of(q + Model::kRunOut, q + Model::kLineOffset, IsZero<T>)) {
  if (!runs_out) SetMount({q[Model::kM], q[Model::kN], q[Model::kTiltX], q[Model::kTiltY]}, q);
  TurnTo(alpha, q, motion);
}

template <class T>
void Model::Residual(const Target& plane, const View& profile, const Seen<T>& q, T* r) const {
  const T turn[3] = {q[kNormal1] * plane.e1[0] + q[kNormal2] * plane.e2[0],
                     q[kNormal1] * plane.e1[1] + q[kNormal2] * plane.e2[1],
                     q[kNormal1] * plane.e1[2] + q[kNormal2] * plane.e2[2]};
  Eigen::Matrix<T, 3, 1> normal;
  Rotate(turn, plane.normal, normal.data());
  const ProfileInTable<T> in_table(profile.alpha, q.q, profile.motion);
  const Eigen::Matrix<T, 3, 1> n = in_table.TurnedBack(normal);
  const auto along = [&n](const Eigen::Matrix<T, 3, 1>& v) { return T(n[0] * v[0] + n[1] * v[1] + n[2] * v[2]); };
  // n . P - d = at_origin + by_y y + by_z z + by_depth bend
  const T at_origin = along(in_table.origin) - (plane.distance + q[kDistance]);
  const T by_y = along(in_table.along_y), by_z = along(in_table.along_z), by_depth = along(in_table.along_depth);
  // n . dP/dnoise of a row of weight one. With the scale, or the noise itself would prefer a small one.
  const T along_noise = profile.along_range ? -at_origin : by_y;
  const T scale = residuals_ == Residuals::kDepth ? 1.0 / along_noise : T(1.0);
  const bool has_form = profile.form.size() && !std::all_of(q.q + kForm, q.q + kForm + kFormModes, IsZero<T>);
  T offset = q[kLineOffset];
  for (int k = 0; k < kDrifts; ++k)
    if (profile.motion.elapsed[k] != 0) offset += profile.motion.elapsed[k] * q[kDriftSweep + k];
  if (profile.along_range) offset -= q[kRangeOffset];
  for (int i = 0; i < Points(profile); ++i) {
    const PseudoPoint& p = profile.points[i];
    const T distance = at_origin + by_y * p.y + by_z * p.z;
    T noise = q(i, kNoiseY);
    if (profile.line.size()) noise += profile.line(i, 0) * offset + profile.line(i, 1) * q[kLineSlope];
    r[i] = p.weight * distance - along_noise * noise - by_z * q(i, kNoiseZ);
    for (size_t k = 0; k < kBends.size() && profile.bend.size(); ++k)
      if (!IsZero(q[kBends[k]])) r[i] += by_depth * q[kBends[k]] * profile.bend(i, static_cast<Eigen::Index>(k));
    if (has_form)
      for (int k = 0; k < kFormModes; ++k) r[i] -= profile.form(i, k) * q[kForm + k];
    r[i] *= scale;
  }
}

}  // namespace scancal::turntable
