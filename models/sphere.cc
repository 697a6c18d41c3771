#include "models/sphere.h"
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include "models/median.h"
#include "solver/dense.h"
#include "solver/linearize.h"
#include "solver/model.h"
#include "solver/random.h"
#include "solver/refine.h"
#include "solver/uncertainty/budget.h"
#include "solver/uncertainty/covariance.h"

namespace scancal {
namespace {

using PointRows = Eigen::Matrix<double, Eigen::Dynamic, 3>;

// r = |p - c| - R, coordinates from the mean of the points.
class Sphere {
 public:
  enum { kX, kY, kZ, kRadius };
  static constexpr int kRowsPerPoint = 1;
  using View = PointRows;
  struct Target {
    std::string name;
    std::vector<View> views;
  };
  Sphere(const Eigen::Vector3d& centre, double radius, Role role, double u)
      : quantities_{{"x", Unit::kMm, Scope::kSystem, Role::kEstimate, centre[0], 0, false, ""},
                    {"y", Unit::kMm, Scope::kSystem, Role::kEstimate, centre[1], 0, false, ""},
                    {"z", Unit::kMm, Scope::kSystem, Role::kEstimate, centre[2], 0, false, ""},
                    {"radius", Unit::kMm, Scope::kSystem, role, radius, u, false, ""}} {}
  const Quantities& quantities() const { return quantities_; }
  int Points(const View& view) const { return static_cast<int>(view.rows()); }
  double Count(const View& view) const { return static_cast<double>(view.rows()); }
  template <class T>
  void Residual(const Target&, const View& view, const Seen<T>& q, T* r) const {
    for (int i = 0; i < Points(view); ++i) {
      const T p[3] = {T(view(i, 0)), T(view(i, 1)), T(view(i, 2))};
      r[i] = SphereDistance(p, q.q, q[kRadius]);
    }
  }

 private:
  Quantities quantities_;
};

struct Start {
  Eigen::Vector3d centre;
  double radius;
};

// p: from their mean.
Start ClosedForm(const PointRows& p, const SphereChoice& choice, const Eigen::Vector3d& outside) {
  const double spread = p.rowwise().squaredNorm().mean();
  Eigen::MatrixXd rows(p.rows(), 4);
  rows << 2 * p, Eigen::VectorXd::Ones(p.rows());
  Eigen::Vector3d centre = LeastSquares(rows, p.rowwise().squaredNorm()).topRows<3>();
  // Along the normal of the cap the centre is least certain: there a known radius and side take its place.
  const Eigen::Vector3d normal = SvdOf(p).v.col(2);
  const Eigen::Vector3d across = centre - normal * normal.dot(centre);
  double height = normal.dot(centre);
  if (choice.radius)
    height = std::copysign(std::sqrt(std::max(0.0, std::pow(choice.radius->value, 2) - spread - across.squaredNorm())),
                           height);
  if (choice.outside) height = std::copysign(height, -normal.dot(outside));
  centre = across + height * normal;
  return {centre, choice.radius ? choice.radius->value : std::sqrt(spread + centre.squaredNorm())};
}

std::string Doubt(const Fit& fit, const Observability& seen) {
  if (!seen.undetermined.empty()) return "the points lie on a plane or a line and determine no sphere";
  return fit.converged ? "" : fit.message.english;
}

constexpr size_t kFewest = 8, kPointsTried = 400;
constexpr int kDraws = 200, kRounds = 20;
constexpr double kRounding_mm = 1e-9;  // nearer than this is on the sphere

struct Ball {  // a candidate
  Eigen::Vector3d centre;
  double radius;
  double Off(const Eigen::Vector3d& p) const { return std::abs((p - centre).norm() - radius); }
};

using Points = std::vector<Eigen::Vector3d>;

// Through four points; none, or a wild one, if they lie on a circle.
void AppendThroughFour(const Points& p, std::vector<Ball>* balls) {
  const Eigen::Vector3d a = p[1] - p[0], b = p[2] - p[0], c = p[3] - p[0], bc = b.cross(c);
  const double volume = a.dot(bc);
  if (!(std::abs(volume) > 1e-15 * a.norm() * b.norm() * c.norm())) return;
  const Eigen::Vector3d centre =
      (a.squaredNorm() * bc + b.squaredNorm() * c.cross(a) + c.squaredNorm() * a.cross(b)) / (2 * volume);
  balls->push_back({p[0] + centre, centre.norm()});
}

// Of a known radius through three points: one on either side, or none.
void AppendThroughThree(const Points& p, double radius, std::vector<Ball>* balls) {
  const Eigen::Vector3d a = p[1] - p[0], b = p[2] - p[0], normal = a.cross(b);
  if (normal.norm() <= 1e-9 * a.norm() * b.norm()) return;
  const Eigen::Vector3d middle =
      (a.squaredNorm() * b.cross(normal) + b.squaredNorm() * normal.cross(a)) / (2 * normal.squaredNorm());
  const double height = radius * radius - middle.squaredNorm();
  if (height < 0) return;
  for (const double side : {-1.0, 1.0})
    balls->push_back({p[0] + middle + side * std::sqrt(height) * normal.normalized(), radius});
}

std::vector<double> Distances(const Ball& ball, std::span<const Eigen::Vector3d> points) {
  std::vector<double> distances;
  for (const Eigen::Vector3d& p : points) distances.push_back(ball.Off(p));
  return distances;
}

// The one with the least median distance; of none an infinite one.
Ball LeastMedian(std::span<const Eigen::Vector3d> points, const SphereChoice& choice) {
  Random random(1, points.size());
  const auto draw = [&] { return points[static_cast<size_t>(random.Uniform() * static_cast<double>(points.size()))]; };
  Points sample;
  const size_t n = std::min(points.size(), kPointsTried);
  for (size_t k = 0; k < n; ++k) sample.push_back(points[k * points.size() / n]);
  std::vector<Ball> balls;
  for (int k = 0; k < kDraws; ++k) {
    if (choice.radius) AppendThroughThree({draw(), draw(), draw()}, choice.radius->value, &balls);
    else AppendThroughFour({draw(), draw(), draw(), draw()}, &balls);
  }
  Ball best{points[0], std::numeric_limits<double>::infinity()};
  double least = best.radius;
  for (const Ball& ball : balls) {
    const double median = Median(Distances(ball, sample));
    if (median < least) {
      least = median;
      best = ball;
    }
  }
  return best;
}

}  // namespace

SphereFit FitSphere(std::span<const Eigen::Vector3d> points, const SphereChoice& choice) {
  const bool free = !choice.radius;
  SphereFit result;
  result.dof = static_cast<double>(points.size()) - (free ? 4 : 3);
  if (result.dof < 1) {
    result.doubt =
        "found " + std::to_string(points.size()) + " points, expected " + (free ? "five" : "four") + " or more";
    return result;
  }
  PointRows p(std::ssize(points), 3);
  for (size_t i = 0; i < points.size(); ++i) p.row(static_cast<Eigen::Index>(i)) = points[i];
  const Eigen::RowVector3d mean = p.colwise().mean();
  p.rowwise() -= mean;
  const Start start = ClosedForm(p, choice, choice.outside.value_or(mean) - mean.transpose());

  const double u = free ? 0 : choice.radius->u;
  const Role role = free ? Role::kEstimate : u > 0 ? Role::kConsider : Role::kHold;
  const Problem problem =
      MakeProblem<Sphere>(std::make_shared<Sphere>(start.centre, start.radius, role, u), {{"sphere", {p}}});
  const Fit fit = Refine(problem, NominalStart(problem));
  const Linearization linear = Linearize(problem, fit.estimate, Storey::kViews);
  const Eigen::VectorXd& x = fit.estimate.system;
  result.centre = mean.transpose() + x.head<3>();
  result.radius = free ? x[3] : start.radius;
  result.sigma = std::sqrt(fit.cost / result.dof);
  result.iterations = fit.iterations;
  result.doubt = Doubt(fit, Observe(problem, linear));
  result.covariance.topLeftCorner(x.size(), x.size()) = NaiveCovariance(problem, linear).matrix;
  if (role == Role::kConsider) {
    Eigen::Vector4d by_radius(0, 0, 0, 1);
    by_radius.head<3>() = BudgetOf(problem, fit.estimate, linear).lines.front().sensitivity;
    result.covariance += by_radius * by_radius.transpose() * u * u;
  }
  return result;
}

RobustSphere FitRobustSphere(std::span<const Eigen::Vector3d> points, const SphereChoice& choice) {
  RobustSphere result;
  result.off.assign(points.size(), false);
  Ball ball{};
  if (points.size() >= kFewest) ball = LeastMedian(points, choice);
  if (!std::isfinite(ball.radius) || points.size() < kFewest) {
    result.fit = FitSphere(points, choice);
    return result;
  }
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<double> distances = Distances(ball, points);
    const double sigma = round == 0 ? kMadToSigma * Median(distances) : result.fit.sigma;
    const double within = std::max(kOffSphere * sigma, kRounding_mm);
    std::vector<bool> off(points.size());
    Points on;
    for (size_t i = 0; i < points.size(); ++i) {
      off[i] = distances[i] > within;
      if (!off[i]) on.push_back(points[i]);
    }
    if (round > 0 && off == result.off) break;
    result.off = std::move(off);
    result.set_aside = static_cast<int>(points.size() - on.size());
    result.fit = FitSphere(on, choice);
    ball = {result.fit.centre, result.fit.radius};
  }
  return result;
}

}  // namespace scancal
