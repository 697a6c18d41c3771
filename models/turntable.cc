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
  Legendre p;
  for (int degree = 0; degree <= kHighest; ++degree)
    p[degree] = std::sqrt(2.0 * degree + 1) * std::legendre(static_cast<unsigned>(degree), x);
  return p;
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
  declare("normal_1", Unit::kRad, kTarget, Role::kEstimate, true);
  declare("normal_2", Unit::kRad, kTarget, Role::kEstimate, true);
  declare("distance", Unit::kMm, kTarget, Role::kEstimate, true);
  // Of these `estimate` means their variance.
  declare("encoder_jitter", Unit::kRad, kView, Role::kEstimate, false);
  declare("line_offset", Unit::kMm, kView, Role::kEstimate, false, "line_correlation (offset)");
  declare("line_slope", Unit::kRad, kView, Role::kEstimate, false, "line_correlation (slope)");
  declare("noise_y", Unit::kMm, kPoint, Role::kEstimate, false);
  declare("noise_z", Unit::kMm, kPoint, Role::kHold, false);
  for (int k = 0; k < kFormModes; ++k)
    declare(("form_" + std::to_string(k + 1)).c_str(), Unit::kMm, kTarget, Role::kHold, false, "form");
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

double System::Bend(double y) const {
  constexpr double kNoExtent_mm = 1e-9;
  const double eta = (2 * y - depths[0] - depths[1]) / std::max(depths[1] - depths[0], kNoExtent_mm);
  return eta * eta;
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

Eigen::Vector3d System::Point(double alpha, double y, double z) const { return At(alpha).Point(y, z, Bend(y)); }

System::Derivatives System::Differentiate(double alpha, double y, double z) const {
  using Jet = ceres::Jet<double, kQuantities>;
  std::array<Jet, Model::kForm> seeds = OfOneProfile<Jet>(q);
  for (int k = 0; k < static_cast<int>(kQuantities); ++k) seeds[k].v[k] = 1;
  const Eigen::Matrix<Jet, 3, 1> p = ProfileInTable<Jet>(alpha, seeds.data()).Point(y, z, Bend(y));
  Derivatives result;
  for (int i = 0; i < 3; ++i) {
    result.point[i] = p[i].a;
    result.by.row(i) = p[i].v.transpose();
  }
  return result;
}

}  // namespace scancal::turntable
