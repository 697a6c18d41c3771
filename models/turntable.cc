#include "models/turntable.h"
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <numbers>

namespace scancal::turntable {
namespace {

constexpr int kLowest = 2, kHighest = 4;

using Legendre = std::array<double, kHighest + 1>;

// Orthonormal on [-1, 1] under its uniform distribution.
Legendre LegendreAt(double x) {
  constexpr double k3 = 1.7320508075688772, k5 = 2.23606797749979, k7 = 2.6457513110645907;  // their roots
  const double xx = x * x;
  return {1, k3 * x, k5 * (3 * xx - 1) / 2, k7 * x * (5 * xx - 3) / 2, 3 * ((35 * xx - 30) * xx + 3) / 8};
}

}  // namespace

FormModes FormModesAt(double u, double v, double aspect) {
  const Legendre in_u = LegendreAt(std::clamp(u, -1.0, 1.0)), in_v = LegendreAt(std::clamp(v, -1.0, 1.0));
  FormModes modes;
  size_t k = 0;
  double squares = 0;
  for (int degree = kLowest; degree <= kHighest; ++degree) {
    for (int i = 0; i <= degree; ++i) {
      const double waves = i + aspect * (degree - i), share = 1 / (waves * waves);
      modes[k++] = share * in_u[i] * in_v[degree - i];
      squares += share * share;
    }
  }
  for (double& mode : modes) mode /= std::sqrt(squares);
  return modes;
}

Model::Model(Residuals residuals) : residuals_(residuals) {
  using enum Scope;
  const auto declare = [&](const char* name, Unit unit, Scope scope, Role role, bool in_nodes,
                           const char* source = "") {
    quantities_.push_back({name, unit, scope, role, 0, 0, in_nodes, source});
  };
  declare("M", Unit::kMm, kSystem, Role::kEstimate, true);
  declare("N", Unit::kMm, kSystem, Role::kEstimate, true);
  declare("tilt_x", Unit::kRad, kSystem, Role::kHold, true);
  declare("tilt_y", Unit::kRad, kSystem, Role::kHold, true);
  declare("scale_y", Unit::kOne, kSystem, Role::kHold, true);
  declare("scale_z", Unit::kOne, kSystem, Role::kHold, true);
  declare("shear", Unit::kRad, kSystem, Role::kHold, true);
  declare("linearity", Unit::kMm, kSystem, Role::kHold, false);
  for (const char* name : {"encoder_cos1", "encoder_sin1", "encoder_cos2", "encoder_sin2"})
    declare(name, Unit::kRad, kSystem, Role::kHold, false);
  declare("expansion", Unit::kOne, kSystem, Role::kHold, true);
  for (const char* name : {"linearity_3", "lens_z2", "lens_yz", "lens_yz2", "range_offset"})
    declare(name, Unit::kMm, kSystem, Role::kHold, false);
  declare("range_scale", Unit::kOne, kSystem, Role::kHold, true);
  declare("encoder_scale", Unit::kOne, kSystem, Role::kHold, false);
  declare("normal_1", Unit::kRad, kTarget, Role::kEstimate, true);
  declare("normal_2", Unit::kRad, kTarget, Role::kEstimate, true);
  declare("distance", Unit::kMm, kTarget, Role::kEstimate, true);
  // Of these `estimate` means their variance.
  declare("encoder_jitter", Unit::kRad, kView, Role::kEstimate, false);
  declare("backlash", Unit::kRad, kSystem, Role::kHold, false);
  declare("latency", Unit::kRad, kSystem, Role::kHold, false);
  for (int k = 0; k < kRunOuts; ++k)
    declare(("runout_" + std::to_string(k + 1)).c_str(), Unit::kMm, kSystem, Role::kHold, false, "runout");
  for (int k = 0; k < kRunOuts; ++k)
    declare(("wobble_" + std::to_string(k + 1)).c_str(), Unit::kRad, kSystem, Role::kHold, false, "wobble");
  declare("line_offset", Unit::kMm, kView, Role::kEstimate, false, "line_correlation (offset)");
  declare("line_slope", Unit::kRad, kView, Role::kEstimate, false, "line_correlation (slope)");
  for (const int k : {kEncoderJitter, kLineOffset, kLineSlope}) quantities_[static_cast<size_t>(k)].in_order = true;
  declare("noise_y", Unit::kMm, kPoint, Role::kEstimate, false);
  declare("noise_z", Unit::kMm, kPoint, Role::kHold, false);
  for (const char* name : {"drift_sweep", "drift", "warm_up", "drift_temperature"})
    declare(name, Unit::kMm, kSystem, Role::kHold, false);
  for (int k = 0; k < kFormModes; ++k)
    declare(("form_" + std::to_string(k + 1)).c_str(), Unit::kMm, kTarget, Role::kHold, false, "form");
}

namespace {

// n . P - d = A + Y y + Z z + B bend (mm) of a profile, or what these become by a change.
struct Four {
  double A = 0, Y = 0, Z = 0, B = 0;
};

// What all profiles of a placement share: the plane's normal with its derivatives.
struct Placed {
  Placed(const Model::Target& plane, const double* q) : distance(plane.distance + q[Model::kDistance]) {
    const Eigen::Vector3d turn = q[Model::kNormal1] * plane.e1 + q[Model::kNormal2] * plane.e2;
    Rotate(turn.data(), plane.normal, normal.data());
    // The normal is v cos t + (w x v) sin(t) / t, w its rotation vector of length t across v.
    const double t2 = turn.squaredNorm(), t = std::sqrt(t2);
    const bool small = t < 1e-4;
    const double sinc = small ? 1 - t2 / 6 : std::sin(t) / t;
    const double bent = small ? -1.0 / 3 + t2 / 30 : (t * std::cos(t) - std::sin(t)) / (t2 * t);  // sinc' / t
    for (const int k : {0, 1}) {
      const Eigen::Vector3d& e = k == 0 ? plane.e1 : plane.e2;
      const double along = q[Model::kNormal1 + k];
      leans[k] = -sinc * along * plane.normal + sinc * e.cross(plane.normal) + bent * along * turn.cross(plane.normal);
    }
  }
  double distance;
  Eigen::Vector3d normal;
  std::array<Eigen::Vector3d, 2> leans;  // d normal / d normal_1, normal_2
};

// One profile's four numbers and their derivatives. Every quantity of the system and of the plane moves its rows by
// them alone. What turns the profile moves n, the normal turned back to the profiler, by dn/da = (-n_y, n_x, 0).
class ProfileDerivatives {
 public:
  ProfileDerivatives(const Placed& placed, const double* q) : placed_(placed), q_(q), in_table_(0, q) {}

  void TurnTo(const Model::View& profile) {
    alpha_ = profile.alpha;
    motion_ = profile.motion;
    in_table_.TurnTo(alpha_, q_, motion_);
    n_ = in_table_.TurnedBack(placed_.normal);
  }

  Four Value() const {
    Four at = Along(n_);
    at.A -= placed_.distance;
    return at;
  }

  Four By(int quantity) const {
    const double growth = 1 + q_[Model::kExpansion];
    if (quantity >= Model::kRunOut && quantity < Model::kLineOffset) {
      constexpr std::array kOf = {Model::kM, Model::kN, Model::kTiltX, Model::kTiltY};
      const int k = quantity - Model::kRunOut;
      return Times(Harmonic(k % 4, alpha_), By(kOf[static_cast<size_t>(k / 4)]));
    }
    switch (quantity) {
      case Model::kM:
        return {-n_[0] * growth};
      case Model::kN:
        return {n_[1] * growth};
      case Model::kExpansion:
        return {n_.dot(in_table_.origin) / growth};
      case Model::kTiltX:
        return Tilted(n_.dot(Height()), -n_.dot(Depth()));
      case Model::kTiltY: {  // n . dRy/d(tilt_y), of what the tilt about X leaves along Z
        const double across = n_[0] * in_table_.cy - n_[2] * in_table_.sy;
        return Tilted(across * in_table_.sx, across * in_table_.cx);
      }
      case Model::kScaleY:
        return {0, n_.dot(Depth())};
      case Model::kScaleZ:
        return {0, 0, n_.dot(Height())};
      case Model::kRangeScale:
        return {0, n_.dot(Depth()), n_.dot(Height())};
      case Model::kShear:
        return {0, 0, n_.dot(Depth())};
      case Model::kEncoderScale:
        return Turned(-alpha_);
      case Model::kBacklash:
        return Turned(-motion_.direction / 2);
      case Model::kLatency:
        return Turned(-motion_.speed);
      case Model::kEncoderJitter:
        return Turned(-1);
      case Model::kEncoderCos1:
        return Turned(-std::cos(alpha_));
      case Model::kEncoderSin1:
        return Turned(-std::sin(alpha_));
      case Model::kEncoderCos2:
        return Turned(-std::cos(2 * alpha_));
      case Model::kEncoderSin2:
        return Turned(-std::sin(2 * alpha_));
      case Model::kNormal1:
      case Model::kNormal2:
        return Along(in_table_.TurnedBack(placed_.leans[quantity - Model::kNormal1]));
      default:
        return {-1};  // distance
    }
  }

 private:
  Four Along(const Eigen::Vector3d& m) const {
    return {m.dot(in_table_.origin), m.dot(in_table_.along_y), m.dot(in_table_.along_z), m.dot(Depth())};
  }
  const Eigen::Vector3d& Depth() const { return in_table_.along_depth; }
  Eigen::Vector3d Height() const { return {in_table_.sy * in_table_.cx, -in_table_.sx, in_table_.cy * in_table_.cx}; }
  static Four Times(double factor, const Four& four) {
    return {factor * four.A, factor * four.Y, factor * four.Z, factor * four.B};
  }
  Four Turned(double da) const { return Along({-n_[1] * da, n_[0] * da, 0}); }
  // By a change of the columns (depth, height) that is so long along n.
  Four Tilted(double of_depth, double of_height) const {
    const double range = q_[Model::kRangeScale];
    return {0, of_depth * (1 + q_[Model::kScaleY] + range),
            of_height * (1 + q_[Model::kScaleZ] + range) + of_depth * q_[Model::kShear], of_depth};
  }

  const Placed& placed_;
  const double* q_;
  double alpha_ = 0;
  Model::Motion motion_;
  ProfileInTable<double> in_table_;
  Eigen::Vector3d n_;
};

}  // namespace

void Model::Jacobian(const Target& plane, std::span<const View> profiles, const Seen<double>& seen,
                     std::span<const int> seeds, double* r, double* jacobian) const {
  const Placed placed(plane, seen.q);
  const bool depth = residuals_ == Residuals::kDepth;
  const bool formed = !std::all_of(seen.q + kForm, seen.q + kForm + kFormModes, IsZero<double>);
  std::ptrdiff_t rows = 0;
  for (const View& profile : profiles) rows += Points(profile);
  const auto moves = [&](int k) { return seen[k] != 0; };
  bool drifts = moves(kRangeOffset);
  for (int k = 0; k < kDrifts; ++k) drifts |= moves(kDriftSweep + k);
  const bool quiet =
      !seen.point && !moves(kNoiseY) && !moves(kNoiseZ) && !moves(kLineOffset) && !moves(kLineSlope) && !drifts;
  const bool bends_by = std::any_of(kBends.begin(), kBends.end(), moves);
  std::array<int, kForm> bend_of;  // by quantity: its shape, or -1
  bend_of.fill(-1);
  for (size_t k = 0; k < kBends.size(); ++k) bend_of[static_cast<size_t>(kBends[k])] = static_cast<int>(k);
  Seen<double> q = seen;
  ProfileDerivatives derivatives(placed, q.q);
  for (const View& profile : profiles) {
    const int points = Points(profile);
    const bool bends = bends_by && profile.bend.size();
    derivatives.TurnTo(profile);
    const Four at = derivatives.Value();
    const double along_noise = profile.along_range ? -at.A : at.Y, scale = depth ? 1 / along_noise : 1;
    double offset = q[kLineOffset];
    for (int k = 0; k < kDrifts && drifts; ++k) offset += profile.motion.elapsed[k] * q[kDriftSweep + k];
    if (profile.along_range) offset -= q[kRangeOffset];
    // The row of one change of the four numbers; along: the change of along_noise.
    const auto row = [&](int i, const Four& four, double along) {
      const PseudoPoint& p = profile.points[i];
      double sum = p.weight * (four.A + four.Y * p.y + four.Z * p.z);
      for (size_t k = 0; k < kBends.size() && bends; ++k)
        sum += four.B * q[kBends[k]] * profile.bend(i, static_cast<Eigen::Index>(k));
      if (quiet) return sum;
      sum -= along * q(i, kNoiseY) + four.Z * q(i, kNoiseZ);
      if (profile.line.size()) sum -= along * (profile.line(i, 0) * offset + profile.line(i, 1) * q[kLineSlope]);
      return sum;
    };
    for (int i = 0; i < points; ++i) {
      r[i] = row(i, at, along_noise);
      for (int k = 0; k < kFormModes && formed && profile.form.size(); ++k) r[i] -= profile.form(i, k) * q[kForm + k];
      r[i] *= scale;
    }
    for (size_t k = 0; k < seeds.size(); ++k) {
      double* const column = jacobian + static_cast<std::ptrdiff_t>(k) * rows;
      const int seed = seeds[k];
      const int shape = seed < kForm ? bend_of[static_cast<size_t>(seed)] : -1;
      if (seed < kLineOffset && shape < 0 && seed != kRangeOffset) {
        const Four four = derivatives.By(seed);
        const double along = profile.along_range ? -four.A : four.Y;
        for (int i = 0; i < points; ++i)
          column[i] = depth ? (row(i, four, along) - r[i] * along) * scale : row(i, four, along);
        continue;
      }
      for (int i = 0; i < points; ++i) {
        double of_point = 0;
        if (seed == kNoiseY) of_point = along_noise;
        else if (seed == kNoiseZ) of_point = at.Z;
        else if (seed >= kForm) of_point = profile.form.size() ? profile.form(i, seed - kForm) : 0;
        else if (shape >= 0) of_point = profile.bend.size() ? -at.B * profile.bend(i, shape) : 0;
        else if (profile.line.size())
          of_point =
              along_noise * (seed == kLineSlope     ? profile.line(i, 1)
                             : seed == kLineOffset  ? profile.line(i, 0)
                             : seed != kRangeOffset ? profile.line(i, 0) * profile.motion.elapsed[seed - kDriftSweep]
                             : profile.along_range  ? -profile.line(i, 0)
                                                    : 0);
        column[i] = -of_point * scale;
      }
    }
    r += points;
    jacobian += points;
    if (q.point) q.point += points * q.count;
  }
}

std::vector<StandIns<Model::View>> Model::MakeNodes(const Target& target) const {
  if (residuals_ == Residuals::kDepth || target.views.empty()) return {};
  double first = target.views.front().alpha, last = first, weight = 0, y = 0, z = 0, yy = 0, zz = 0;
  for (const View& view : target.views) {
    first = std::min(first, view.alpha);
    last = std::max(last, view.alpha);
    for (const PseudoPoint& p : view.points) {
      const double w = p.weight * p.weight;
      weight += w;
      y += w * p.y;
      z += w * p.z;
      yy += w * p.y * p.y;
      zz += w * p.z * p.z;
    }
  }
  // Three angles on a full turn must not repeat, so 4/3 pi is as far apart as they go.
  const double sweep = std::min(last - first, 4 * std::numbers::pi / 3);
  constexpr double kNoSweep = 1e-6;
  if (!(sweep > kNoSweep) || !(weight > 0)) return {};
  y /= weight;
  z /= weight;
  const double spread_y = std::max(1.0, std::sqrt(std::max(0.0, yy / weight - y * y)));
  const double spread_z = std::max(1.0, std::sqrt(std::max(0.0, zz / weight - z * z)));
  const std::vector<PseudoPoint> points = {{1, y, z}, {1, y + spread_y, z}, {1, y, z + spread_z}};
  const std::vector<View> nodes = {
      {first, points, 0, false}, {first + sweep / 2, points, 0, false}, {first + sweep, points, 0, false}};
  return {{nodes, target.views.size()}};
}

Eigen::MatrixXd Model::Interpolate(const std::vector<View>& nodes, const View& view) const {
  Eigen::Matrix3d turn;
  for (int k = 0; k < 3; ++k) turn.col(k) << 1, std::cos(nodes[k].alpha), std::sin(nodes[k].alpha);
  const Eigen::Vector3d by_turn = turn.inverse() * Eigen::Vector3d(1, std::cos(view.alpha), std::sin(view.alpha));
  const PseudoPoint &origin = nodes[0].points[0], &along_y = nodes[0].points[1], &along_z = nodes[0].points[2];
  Eigen::MatrixXd result(Points(view), 9);
  for (int i = 0; i < Points(view); ++i) {
    const PseudoPoint& p = view.points[i];
    const double in_y = (p.y - origin.y) / (along_y.y - origin.y), in_z = (p.z - origin.z) / (along_z.z - origin.z);
    const Eigen::RowVector3d on_line(1 - in_y - in_z, in_y, in_z);
    for (int k = 0; k < 3; ++k) result.block<1, 3>(i, 3 * k) = p.weight * by_turn[k] * on_line;
  }
  return result;
}

std::pair<Eigen::Vector3d, double> Model::Plane(const Target& plane, const Eigen::Vector3d& own) {
  const Eigen::Vector3d turn = own[0] * plane.e1 + own[1] * plane.e2;
  Eigen::Vector3d normal;
  Rotate(turn.data(), plane.normal, normal.data());
  return {normal, plane.distance + own[2]};
}

void Model::SetPlane(const Eigen::Vector3d& normal, double distance, Target* target) {
  target->normal = normal.normalized();
  target->distance = distance;
  target->e1 = target->normal.unitOrthogonal();
  target->e2 = target->normal.cross(target->e1);
}

System System::With(double M, double N) const {
  System system = *this;
  system[Model::kM] = M;
  system[Model::kN] = N;
  return system;
}

std::array<double, Model::kBends.size()> System::Shapes(double y, double z) const {
  const auto scaled = [](double value, const std::array<double, 2>& over) {
    return (2 * value - over[0] - over[1]) / std::max(over[1] - over[0], 1e-9);  // mm: any extent
  };
  const double eta = scaled(y, depths), zeta = scaled(z, heights);
  return {eta * eta, eta * eta * eta, zeta * zeta, eta * zeta, eta * zeta * zeta};
}

double System::Bend(double y, double z) const {
  if (!Bends()) return 0;
  const auto shapes = Shapes(y, z);
  double bend = 0;
  for (size_t k = 0; k < shapes.size(); ++k) bend += q[Model::kBends[k]] * shapes[k];
  return bend;
}

bool System::Bends() const {
  return std::any_of(Model::kBends.begin(), Model::kBends.end(), [&](Model::Index k) { return q[k] != 0; });
}

namespace {

// With what a profile has besides: none of it.
template <class T>
std::array<T, Model::kForm> OfOneProfile(const std::array<double, System::kQuantities>& system) {
  std::array<T, Model::kForm> q;
  q.fill(T(0.0));
  for (size_t k = 0; k < system.size(); ++k) q[k] = T(system[k]);
  return q;
}

}  // namespace

ProfileInTable<double> System::At(double alpha) const { return {alpha, OfOneProfile<double>(q).data()}; }

Eigen::Vector3d System::Point(double alpha, double y, double z) const {
  const double range = std::hypot(y, z), longer = range > 0 ? 1 + q[Model::kRangeOffset] / range : 1;
  return At(alpha).Point(longer * y, longer * z, Bend(y, z));
}

System::Derivatives System::Differentiate(double alpha, double y, double z) const {
  using Jet = ceres::Jet<double, kQuantities>;
  std::array<Jet, Model::kForm> seeds = OfOneProfile<Jet>(q);
  for (int k = 0; k < static_cast<int>(kQuantities); ++k) seeds[k].v[k] = 1;
  const double range = std::hypot(y, z);
  const Jet longer = range > 0 ? 1.0 + seeds[Model::kRangeOffset] / range : Jet(1.0);
  const auto shapes = Shapes(y, z);
  Jet bend(0.0);
  for (size_t k = 0; k < shapes.size(); ++k) bend += seeds[Model::kBends[k]] * shapes[k];
  const ProfileInTable<Jet> in_table(alpha, seeds.data());
  const Eigen::Matrix<Jet, 3, 1> p = in_table.Turned(in_table.origin + in_table.along_y * (longer * y) +
                                                     in_table.along_z * (longer * z) + in_table.along_depth * bend);
  Derivatives result;
  for (int i = 0; i < 3; ++i) {
    result.point[i] = p[i].a;
    result.by.row(i) = p[i].v.transpose();
  }
  return result;
}

}  // namespace scancal::turntable
