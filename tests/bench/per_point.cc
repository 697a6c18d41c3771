#include "tests/bench/per_point.h"
#include <ceres/ceres.h>
#include <glog/logging.h>
#include <cmath>
#include "solver/dense.h"
#include "tests/bench/measure.h"

namespace scancal::bench {
namespace {

using Residuals = turntable::Model::Residuals;
constexpr int kPolishSteps = 3;

struct PointResidual {
  const turntable::Model::Target* plane;  // where its normal starts
  double cos_alpha, sin_alpha, y, z;
  Residuals kind;

  template <class T>
  bool operator()(const T* offsets, const T* own, T* residual) const {
    const T &M = offsets[0], &N = offsets[1];
    T n[3];
    for (int k = 0; k < 3; ++k) n[k] = plane->normal[k] + own[0] * plane->e1[k] + own[1] * plane->e2[k];
    const T length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    const T X = M * cos_alpha - (N + y) * sin_alpha;
    const T Y = -M * sin_alpha - (N + y) * cos_alpha;
    const T distance = n[0] * X + n[1] * Y + n[2] * z - own[2] * length;  // times |n|
    residual[0] = distance / (kind == Residuals::kPlane ? length : -n[0] * sin_alpha - n[1] * cos_alpha);
    return true;
  }
};

template <class Visit>
void ForEachPoint(const SimulatedPlacement& placement, const turntable::Model::Target& plane, Residuals residuals,
                  const Visit& visit) {
  for (const SimulatedProfile& profile : placement.profiles) {
    const double c = std::cos(profile.alpha), s = std::sin(profile.alpha);
    for (size_t i = 0; i < profile.y.size(); ++i)
      visit(PointResidual{&plane, c, s, profile.y[i], profile.z[i], residuals});
  }
}

// Rows (dr/dM, dr/dN, dr/downs of placement t, r) of one placement, added to the factor.
void AddRows(const SimulatedPlacement& placement, const turntable::Model::Target& plane, Residuals residuals,
             const PerPointFit& fit, size_t t, TriangularFactor* factor) {
  using Jet = ceres::Jet<double, 5>;
  const Jet offsets[] = {Jet(fit.M, 0), Jet(fit.N, 1)};
  const double* at = fit.planes.data() + 3 * t;
  const Jet own[] = {Jet(at[0], 2), Jet(at[1], 3), Jet(at[2], 4)};
  const Eigen::Index columns = 3 + std::ssize(fit.planes), chunk = 1000;
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(chunk, columns);
  Eigen::Index filled = 0;
  const auto add = [&](const PointResidual& point) {
    Jet r;
    point(offsets, own, &r);
    rows.row(filled).head<2>() = r.v.head<2>();
    rows.row(filled).segment<3>(2 + 3 * static_cast<Eigen::Index>(t)) = r.v.tail<3>();
    rows(filled, columns - 1) = r.a;
    if (++filled < chunk) return;
    factor->Add(rows);
    filled = 0;
  };
  ForEachPoint(placement, plane, residuals, add);
  factor->Add(rows.topRows(filled));
}

}  // namespace

PerPointFit FitPerPoint(const std::vector<SimulatedPlacement>& points, const Start& start, Residuals residuals) {
  PerPointFit fit;
  double offsets[] = {start.M, start.N};
  for (const turntable::Model::Target& plane : start.planes)
    fit.planes.insert(fit.planes.end(), {0, 0, plane.distance});
  const double began = ProcessorSeconds();
  ceres::Problem problem;
  for (size_t t = 0; t < points.size(); ++t) {
    double* const own = fit.planes.data() + 3 * t;
    ForEachPoint(points[t], start.planes[t], residuals, [&](const PointResidual& point) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PointResidual, 1, 2, 3>(new PointResidual(point)),
                               nullptr, offsets, own);
    });
  }
  ceres::Solver::Options options;
  // The fastest of Ceres' linear solvers here; DENSE_SCHUR, the sparse ones and DENSE_QR took longer, in this order.
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 1e-12;
  options.max_num_iterations = 100;
  fit.build_s = ProcessorSeconds() - began;
  ceres::Solver::Summary summary;
  fit.solve_s = SecondsOf([&] { ceres::Solve(options, &problem, &summary); });
  CHECK(summary.IsSolutionUsable()) << summary.FullReport();
  fit.M = offsets[0];
  fit.N = offsets[1];
  fit.cost = 2 * summary.final_cost;
  fit.iterations = static_cast<int>(summary.iterations.size());
  return fit;
}

void Polish(const std::vector<SimulatedPlacement>& points, const Start& start, Residuals residuals, PerPointFit* fit) {
  for (int step = 0; step <= kPolishSteps; ++step) {
    const Eigen::Index unknowns = 2 + std::ssize(fit->planes);
    TriangularFactor factor(static_cast<int>(unknowns) + 1);
    for (size_t t = 0; t < points.size(); ++t) AddRows(points[t], start.planes[t], residuals, *fit, t, &factor);
    const Eigen::MatrixXd r = factor.R();
    fit->cost = r.col(unknowns).squaredNorm();
    if (step == kPolishSteps) break;
    const Eigen::VectorXd delta =
        -r.topLeftCorner(unknowns, unknowns).triangularView<Eigen::Upper>().solve(r.topRightCorner(unknowns, 1));
    fit->M += delta[0];
    fit->N += delta[1];
    for (size_t k = 0; k < fit->planes.size(); ++k) fit->planes[k] += delta[2 + static_cast<Eigen::Index>(k)];
  }
}

}  // namespace scancal::bench
