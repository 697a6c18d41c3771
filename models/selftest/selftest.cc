#include "models/selftest/selftest.h"
#include <glog/logging.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include "io/message.h"
#include "io/number.h"
#include "models/rotation.h"
#include "models/selftest/fit.h"
#include "models/sphere.h"
#include "solver/uncertainty/law_of_propagation.h"

namespace scancal::selftest {
namespace {

constexpr double kDigitsOfDouble = 16;
constexpr double kValues = 10, kDeviations = 8;  // digits required of shapes

double Agreement(double found, const Known& known) {
  const double error = std::abs(found - known.value) / std::abs(known.value);
  if (!std::isfinite(error)) return 0;
  return std::max(0.0, std::min(known.digits, -std::log10(error)));
}

// r = n . p - d, in the coordinates as they are: a lever arm of 60 m, where centring would hide what it costs.
class Plane {
 public:
  enum { kTurn1, kTurn2, kDistance };
  static constexpr int kRowsPerPoint = 1;
  using View = Eigen::Vector3d;
  struct Target {
    std::string name;
    std::vector<View> views;
  };
  explicit Plane(const Eigen::Vector3d& through_a, const Eigen::Vector3d& b, const Eigen::Vector3d& c)
      : normal_((b - through_a).cross(c - through_a).normalized()),
        e1_(normal_.unitOrthogonal()),
        e2_(normal_.cross(e1_)),
        quantities_{{"turn_1", Unit::kRad, Scope::kSystem, Role::kEstimate, 0, 0, false, ""},
                    {"turn_2", Unit::kRad, Scope::kSystem, Role::kEstimate, 0, 0, false, ""},
                    {"distance", Unit::kMm, Scope::kSystem, Role::kEstimate, normal_.dot(through_a), 0, false, ""}} {}
  const Quantities& quantities() const { return quantities_; }
  int Points(const View&) const { return 1; }
  double Count(const View&) const { return 1; }
  template <class T>
  void Normal(const T* q, T n[3]) const {
    T turn[3];
    for (int k = 0; k < 3; ++k) turn[k] = q[kTurn1] * e1_[k] + q[kTurn2] * e2_[k];
    Rotate(turn, normal_, n);
  }
  template <class T>
  void Residual(const Target&, const View& p, const Seen<T>& q, T* r) const {
    T n[3];
    Normal(q.q, n);
    r[0] = n[0] * p[0] + n[1] * p[1] + n[2] * p[2] - q[kDistance];
  }

 private:
  Eigen::Vector3d normal_, e1_, e2_;
  Quantities quantities_;
};

// n, d and their covariance from the estimated turns and distance, d made positive.
SelftestRow CheckPlane(const ExactShape& shape) {
  const auto model = std::make_shared<Plane>(shape.points[0], shape.points[1], shape.points[2]);
  const LeastSquares solved = SolveLeastSquares(MakeProblem<Plane>(model, {{"plane", shape.points}}));
  const Eigen::Vector3d x = solved.fit.estimate.system;
  const double sign = x[Plane::kDistance] < 0 ? -1 : 1;
  const auto plane = Evaluate<4, 3>(
      [&](const auto* q, auto* y) {
        model->Normal(q, y);
        y[3] = q[Plane::kDistance];
      },
      x);
  const Eigen::Matrix4d covariance = PropagateCovariance(plane.sensitivity, solved.covariance.matrix);
  return {shape.name,
          "",
          static_cast<int>(shape.points.size()),
          3,
          Compare(sign * plane.y, shape.values, kValues),
          Compare(covariance.diagonal().cwiseSqrt(), shape.deviations, kDeviations),
          solved.fit.iterations,
          solved.fit.message};
}

SelftestRow CheckSphere(const ExactShape& shape) {
  SphereChoice choice;
  if (shape.known_radius > 0) choice.radius = KnownRadius{shape.known_radius};
  const SphereFit fit = FitSphere(shape.points, choice);
  const Eigen::Index n = std::ssize(shape.values);
  Eigen::Vector4d values;
  values << fit.centre, fit.radius;
  return {shape.name,
          "",
          static_cast<int>(shape.points.size()),
          static_cast<int>(n),
          Compare(values.head(n), shape.values, kValues),
          Compare(fit.covariance.diagonal().head(n).cwiseSqrt(), shape.deviations, kDeviations),
          fit.iterations,
          fit.doubt};
}

}  // namespace

std::vector<SelftestRow> OwnCases() {
  std::vector<SelftestRow> rows = {CheckGaugeBlock(), CheckImpedance(), CheckThermometer()};
  for (const ExactShape& shape : ExactShapes()) rows.push_back(Check(shape));
  return rows;
}

Result<std::vector<SelftestRow>> NistCases(const std::filesystem::path& folder) {
  std::vector<std::string> missing;
  for (const NistModel& model : NistModels())
    if (!std::filesystem::exists(folder / (std::string(model.name) + ".dat"))) missing.emplace_back(model.name);
  if (!missing.empty())
    return Error{folder.string() + ": found " + std::to_string(NistModels().size() - missing.size()) +
                 " of the 27 files of NIST's nonlinear regressions (www.itl.nist.gov/div898/strd), expected all; "
                 "missing .dat files: " +
                 Listed(missing)};
  std::vector<SelftestRow> rows;
  for (const NistModel& model : NistModels()) {
    SCANCAL_ASSIGN_OR_RETURN(const NistData data, ReadNist(folder / (std::string(model.name) + ".dat"), model));
    rows.push_back(Check(model, data));
  }
  return rows;
}

std::optional<Known> ParseKnown(std::string_view text) {
  const ParsedNumber number = ParseNumber(text);
  if (number.kind != NumberKind::kNumber || number.value == 0) return {};
  const std::string_view mantissa = text.substr(0, text.find_first_of("eE"));
  const ParsedNumber exponent = ParseNumber(text.substr(std::min(mantissa.size() + 1, text.size())));
  int digits = 0;
  for (const char c : mantissa) digits += (c >= '1' && c <= '9') || (c == '0' && digits > 0);
  const size_t point = mantissa.find('.');
  const auto decimals = static_cast<double>(point == std::string_view::npos ? 0 : mantissa.size() - point - 1);
  return Known{number.value, std::min<double>(digits, kDigitsOfDouble),
               std::log10(std::abs(number.value)) + decimals - exponent.value};
}

Digits Compare(const Eigen::VectorXd& found, const std::vector<std::string>& known, double required) {
  CHECK_EQ(found.size(), std::ssize(known));
  Digits worst{kAllDigits, 0};
  for (Eigen::Index k = 0; k < found.size(); ++k) {
    const std::optional<Known> number = ParseKnown(known[static_cast<size_t>(k)]);
    CHECK(number) << known[static_cast<size_t>(k)];
    const Digits digits{Agreement(found[k], *number), std::min(required, number->last_place)};
    if (digits.reached - digits.required < worst.reached - worst.required) worst = digits;
  }
  return worst;
}

SelftestRow Check(const ExactShape& shape) {
  return shape.kind == ExactShape::kPlane ? CheckPlane(shape) : CheckSphere(shape);
}

}  // namespace scancal::selftest
