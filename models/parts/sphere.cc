#include "models/parts/sphere.h"
#include <Eigen/QR>
#include <Eigen/SVD>
#include <limits>
#include <vector>
#include "solver/linearize.h"
#include "solver/model.h"
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
  Eigen::MatrixX4d rows(p.rows(), 4);
  rows << 2 * p, Eigen::VectorXd::Ones(p.rows());
  Eigen::Vector3d centre = rows.completeOrthogonalDecomposition().solve(p.rowwise().squaredNorm().matrix()).head<3>();
  // Along the normal of the cap the centre is least certain: there a known radius and side take its place.
  const Eigen::Vector3d normal = p.jacobiSvd(Eigen::ComputeFullV).matrixV().col(2);
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
  return fit.converged ? "" : fit.message;
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

}  // namespace scancal
