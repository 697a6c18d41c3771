#include "models/turntable/search.h"
#include <algorithm>
#include <cmath>
#include "io/progress.h"
#include "models/line/pseudo_points.h"
#include "models/scanner.h"
#include "solver/dense.h"

namespace scancal::turntable {
namespace {

constexpr int kThreads = 2;
constexpr int64_t kMostNodesOfSurface = 61, kNodesNear = 41;  // per side
constexpr double kStepsFromGrid = 3;                          // steps
constexpr double kLeastWidth = 0.01;                          // of a step: exact data have no U

// By inverse iteration, which keeps the small value's relative accuracy.
double SmallestSingularValue(const Eigen::Matrix3d& r) {
  if (!(r(0, 0) > 0) || !(r(1, 1) > 0) || !(r(2, 2) > 0)) return 0;
  const auto upper = r.triangularView<Eigen::Upper>();
  Eigen::Vector3d v = upper.solve(Eigen::Vector3d(0, 0, 1));
  double sigma = 0;
  for (int k = 0; k < 30; ++k) {
    v.normalize();
    const Eigen::Vector3d w = upper.transpose().solve(v);
    const double next = 1 / w.norm();  // sigma of w / |w|
    v = upper.solve(w);
    if (std::abs(next - sigma) <= 1e-13 * next) return next;
    sigma = next;
  }
  return sigma;
}

NumberTable SurfaceTable(const std::vector<PlaneStorey>& storeys, const std::vector<double>& M,
                         const std::vector<double>& N) {
  NumberTable table = TableOf({{"M", Unit::kMm}, {"N", Unit::kMm}, {"S", Unit::kMm}});
  for (const double m : M)
    for (const double n : N) table.rows.push_back({m, n, SAt(storeys, m, n, PlaneFit::kOrthogonal)});
  return table;
}

std::vector<double> Thinned(const GridBox& box, size_t side) {
  const int64_t all = box.Nodes()[side], some = std::min(all, kMostNodesOfSurface);
  std::vector<double> nodes;
  for (int64_t k = 0; k < some; ++k) {
    const int64_t i = some > 1 ? k * (all - 1) / (some - 1) : 0;
    nodes.push_back(box.At(i, i)[side]);
  }
  return nodes;
}

// Half of the square's side; nan where something is not known.
double HalfWidth(const GridBox& box, const Calibration& calibration) {
  double width = kLeastWidth * box.step, to_grid = 0;
  for (const size_t k : {0, 1}) {
    const Parameter& parameter = *calibration.Find(calibration.grid.names[k]);
    if (parameter.role != Role::kEstimate) continue;
    if (!std::isfinite(3 * parameter.U)) return 3 * parameter.U;
    width = std::max(width, 3 * parameter.U);
    to_grid = std::max(to_grid, std::abs(calibration.grid.at[k] - parameter.value));
  }
  constexpr double kMargin = 1.05;  // the minimum is not to lie on the frame
  return to_grid <= kStepsFromGrid * box.step ? std::max(width, kMargin * to_grid) : width;
}

std::vector<double> Around(const Parameter& parameter, double half_width) {
  if (parameter.role != Role::kEstimate) return {parameter.value};
  std::vector<double> nodes;
  constexpr int64_t kMiddle = kNodesNear / 2;
  for (int64_t k = -kMiddle; k <= kMiddle; ++k)
    nodes.push_back(parameter.value + half_width * static_cast<double>(k) / static_cast<double>(kMiddle));
  return nodes;
}

}  // namespace

PlaneStorey::PlaneStorey(const std::vector<Profile>& profiles, const System& system) {
  const System at_axis = system.With(0, 0), at_one = system.With(1, 0);
  TriangularFactor factor(6);
  Eigen::Matrix<double, Eigen::Dynamic, 6> rows;
  for (const Model::View& profile : PlaneViews(profiles, system)) {
    rows.resize(std::ssize(profile.points), 6);
    const ProfileInTable<double> in_table = at_axis.At(profile.alpha);
    const Eigen::Vector3d p_M = at_one.At(profile.alpha).Point(0, 0, 0);  // p_N is p_M a quarter turn on
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      const Eigen::Vector3d p0 = PointOf(system, in_table, profile, i);
      rows.row(i) << 1, p_M[0], -p_M[1], p0[0], p0[1], p0[2];
      rows.row(i) *= profile.points[i].weight;
    }
    factor.Add(rows);
  }
  const Eigen::Matrix<double, 6, 6> r = factor.R();
  const double sign = r(0, 0) < 0 ? -1 : 1;
  root_n_ = sign * r(0, 0);
  mean_ = sign * r.block<1, 5>(0, 1);
  cos_ = r.block<5, 1>(1, 1);
  sin_ = r.block<5, 1>(1, 2);
  x0_ = r.block<5, 1>(1, 3);
  y0_ = r.block<5, 1>(1, 4);
  z_ = r.block<5, 1>(1, 5);
}

Eigen::Matrix3d PlaneStorey::Centred(double M, double N) const {
  return Triangle<Vector5>(M * cos_ - N * sin_ + x0_, -M * sin_ - N * cos_ + y0_, z_);  // eq. (7), simplified
}

double PlaneStorey::Rmse(double M, double N, PlaneFit fit) const {
  const Eigen::Matrix3d r = Centred(M, N);
  if (fit == PlaneFit::kOrthogonal) return SmallestSingularValue(r) / root_n_;
  const double B = r(1, 1) > 0 ? r(1, 2) / r(1, 1) : 0, A = r(0, 0) > 0 ? (r(0, 2) - r(0, 1) * B) / r(0, 0) : 0;
  return r(2, 2) / (root_n_ * std::sqrt(A * A + B * B + 1));
}

std::pair<Eigen::Vector3d, double> PlaneStorey::FitPlane(double M, double N) const {
  Eigen::Vector3d normal = SvdOf(Centred(M, N)).v.col(2);
  const Eigen::Vector3d mean =
      Eigen::Vector3d(M * mean_[0] - N * mean_[1] + mean_[2], -M * mean_[1] - N * mean_[0] + mean_[3], mean_[4]) /
      root_n_;
  double distance = normal.dot(mean);
  if (distance < 0) {
    normal = -normal;
    distance = -distance;
  }
  return {normal, distance};
}

std::vector<PlaneStorey> StoreysOf(const std::vector<Placement>& placements, const System& system) {
  std::vector<PlaneStorey> storeys;
  for (const Placement& placement : placements) storeys.emplace_back(placement.profiles, system);
  return storeys;
}

double SAt(const std::vector<PlaneStorey>& storeys, double M, double N, PlaneFit fit) {
  double sum = 0;
  for (const PlaneStorey& storey : storeys) sum += storey.Rmse(M, N, fit);
  return sum / static_cast<double>(storeys.size());
}

GridResult Search(const GridBox& box, const std::vector<PlaneStorey>& storeys, PlaneFit fit, const std::string& name) {
  Progress progress(name);
  const auto rmse = [&](const std::array<double, 2>& at, std::span<double> values) {
    for (size_t t = 0; t < values.size(); ++t) values[t] = storeys[t].Rmse(at[0], at[1], fit);
  };
  return GridSearch(box, static_cast<int>(storeys.size()), rmse, kThreads, [&](double done) { progress.Show(done); });
}

void AddSurface(const GridBox& box, const std::vector<PlaneStorey>& declared, const std::vector<PlaneStorey>& found,
                Calibration* calibration) {
  calibration->surface["search"] = SurfaceTable(declared, Thinned(box, 0), Thinned(box, 1));
  const double half_width = HalfWidth(box, *calibration);
  if (std::isfinite(half_width))
    calibration->surface["near"] =
        SurfaceTable(found, Around(*calibration->Find("M"), half_width), Around(*calibration->Find("N"), half_width));
}

}  // namespace scancal::turntable
