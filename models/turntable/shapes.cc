#include "models/turntable/shapes.h"
#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include "models/median.h"
#include "models/sphere.h"
#include "solver/dense.h"
#include "solver/random.h"
#include "solver/uncertainty/gum.h"

namespace scancal::turntable {
namespace {

constexpr size_t kFewestOnPlane = 10, kPlaneSample = 400;
constexpr int kPlaneDraws = 200, kPlaneRounds = 20;
constexpr double kExact_mm = 1e-9;  // nearer than this is on the shape

Shape InTable(const System& system, const SeenTarget& target) {
  Shape shape{&target, {}, {}};
  for (size_t i = 0; i < target.points.y.size(); ++i)
    shape.all.push_back(system.Point(target.points.alpha[i], target.points.y[i], target.points.z[i]));
  return shape;
}

Error NotDetermined(const SeenTarget& target, const std::string& why) {
  return {"target " + target.name + ": " + why + "; expected a region (keep:) that holds the feature and little else"};
}

void FitPlaneTo(Shape* shape) {
  shape->centre.setZero();
  for (size_t k = 0; k < shape->on.size(); ++k) shape->centre += shape->At(k) / static_cast<double>(shape->on.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (size_t k = 0; k < shape->on.size(); ++k) {
    const Eigen::Vector3d d = shape->At(k) - shape->centre;
    scatter += d * d.transpose();
  }
  shape->normal = EigenOf(scatter).vectors.col(0);
}

}  // namespace

Result<Shape> SphereOf(const System& system, const SeenTarget& target) {
  Shape shape = InTable(system, target);
  if (shape.all.empty()) return NotDetermined(target, "no points");
  const size_t middle = shape.all.size() / 2;
  SphereChoice choice;
  choice.outside = system.Point(target.points.alpha[middle], 0, target.points.z[middle]);
  const RobustSphere found = FitRobustSphere(shape.all, choice);
  if (!found.fit.doubt.empty()) return NotDetermined(target, found.fit.doubt);
  for (size_t i = 0; i < shape.all.size(); ++i)
    if (!found.off[i]) shape.on.push_back(i);
  shape.centre = found.fit.centre;
  shape.radius = found.fit.radius;
  return shape;
}

Result<Shape> PlaneOf(const System& system, const SeenTarget& target) {
  Shape shape = InTable(system, target);
  const size_t n = shape.all.size();
  if (n < kFewestOnPlane)
    return NotDetermined(target, fmt::format("found {} points, expected {} or more of a plane", n, kFewestOnPlane));
  Random random(1, n);
  const auto draw = [&] { return shape.all[static_cast<size_t>(random.Uniform() * static_cast<double>(n))]; };
  double least = kInfinity;
  const size_t step = std::max<size_t>(1, n / kPlaneSample);
  for (int k = 0; k < kPlaneDraws; ++k) {
    const Eigen::Vector3d a = draw(), b = draw(), c = draw(), normal = (b - a).cross(c - a);
    if (!(normal.norm() > kExact_mm)) continue;
    std::vector<double> distances;
    for (size_t i = 0; i < n; i += step) distances.push_back(std::abs(normal.normalized().dot(shape.all[i] - a)));
    if (const double median = Median(distances); median < least) {
      least = median;
      shape.centre = a;
      shape.normal = normal.normalized();
    }
  }
  if (!std::isfinite(least)) return NotDetermined(target, "the points lie on a line and determine no plane");
  double sigma = kMadToSigma * least;
  for (int round = 0; round < kPlaneRounds; ++round) {
    std::vector<size_t> on;
    for (size_t i = 0; i < n; ++i)
      if (std::abs(shape.normal.dot(shape.all[i] - shape.centre)) <= std::max(kOffSphere * sigma, kExact_mm))
        on.push_back(i);
    if (on == shape.on || on.size() < kFewestOnPlane) break;
    shape.on = std::move(on);
    FitPlaneTo(&shape);
    double squares = 0;
    for (size_t k = 0; k < shape.on.size(); ++k) squares += std::pow(shape.normal.dot(shape.At(k) - shape.centre), 2);
    sigma = std::sqrt(squares / (static_cast<double>(shape.on.size()) - 3));
  }
  return shape;
}

}  // namespace scancal::turntable
