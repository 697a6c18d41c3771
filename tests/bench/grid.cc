#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include "tests/bench/comparisons.h"
#include "tests/reference/zhao_2021.h"

namespace scancal::bench {
namespace {

const GridBox kPublished = {{110, 395}, {130, 425}, 0.1};
// Nodes of the published grid that are timed point by point; it would take hours to do all of them.
constexpr std::array<std::array<double, 2>, 4> kTimed = {{{110, 395}, {123, 409}, {123.4, 408.7}, {130, 425}}};

std::vector<std::vector<zhao_2021::Measurement>> AsMeasured(const std::vector<SimulatedPlacement>& points) {
  std::vector<std::vector<zhao_2021::Measurement>> measured;
  for (const SimulatedPlacement& placement : points) {
    auto& list = measured.emplace_back();
    for (const SimulatedProfile& profile : placement.profiles)
      for (size_t i = 0; i < profile.y.size(); ++i) list.push_back({profile.alpha, profile.y[i], profile.z[i]});
  }
  return measured;
}

// The same S point by point, written for speed: sine and cosine once a profile, eq. (7) without its roots, the plane by
// normal equations about the means, the sums in one pass.
double LeanS(double M, double N, const std::vector<SimulatedPlacement>& points) {
  double s_of_all = 0;
  for (const SimulatedPlacement& placement : points) {
    double n = 0, X = 0, Y = 0, Z = 0, XX = 0, XY = 0, YY = 0, XZ = 0, YZ = 0, ZZ = 0;
    const double middle_N = N + placement.profiles.front().y.front(), z0 = placement.profiles.front().z.front();
    for (const SimulatedProfile& profile : placement.profiles) {
      const double c = std::cos(profile.alpha), s = std::sin(profile.alpha);
      const double* const y = profile.y.data();
      const double* const z = profile.z.data();
      for (size_t i = 0; i < profile.y.size(); ++i) {
        const double x_r = M * c - (N + y[i]) * s, y_r = middle_N - M * s - (N + y[i]) * c, z_r = z[i] - z0;
        X += x_r;
        Y += y_r;
        Z += z_r;
        XX += x_r * x_r;
        XY += x_r * y_r;
        YY += y_r * y_r;
        XZ += x_r * z_r;
        YZ += y_r * z_r;
        ZZ += z_r * z_r;
      }
      n += static_cast<double>(profile.y.size());
    }
    Eigen::Matrix2d normal;
    normal << XX - X * X / n, XY - X * Y / n, XY - X * Y / n, YY - Y * Y / n;
    const Eigen::Vector2d rhs(XZ - X * Z / n, YZ - Y * Z / n);
    const Eigen::Vector2d ab = normal.ldlt().solve(rhs);
    const double squares = std::max(0.0, ZZ - Z * Z / n - ab.dot(rhs));
    s_of_all += std::sqrt(squares / (ab.squaredNorm() + 1) / n);
  }
  return s_of_all / static_cast<double>(points.size());
}

}  // namespace

void CompareGrid(const LargeData& data, Table* table) {
  Say("grid search: published, point by point");
  const std::vector<PlaneStorey> storeys = Storeys(data.placements);
  const auto rmse = [&](const std::array<double, 2>& at, std::span<double> values) {
    for (size_t t = 0; t < values.size(); ++t)
      values[t] = storeys[t].Rmse(at[0], at[1], turntable::PlaneFit::kVertical);
  };
  GridResult grid;
  const int placements = static_cast<int>(storeys.size());
  const double ours_s = MedianSecondsOf([&] { grid = GridSearch(kPublished, placements, rmse); });
  const double storey_s = MedianSecondsOf([&] { Storeys(data.placements); });
  const auto nodes = static_cast<double>(grid.nodes);

  const auto measured = AsMeasured(data.points);
  double published_s = 0, lean_s = 0, difference = 0, lean_difference = 0;
  for (const auto& at : kTimed) {
    std::vector<double> values(storeys.size());
    rmse(at, values);
    double ours = 0;
    for (const double value : values) ours += value / placements;
    double published = 0, lean = 0;
    published_s += SecondsOf([&] { published = zhao_2021::S(at[0], at[1], measured); });
    lean_s += SecondsOf([&] { lean = LeanS(at[0], at[1], data.points); });
    difference = std::max(difference, std::abs(ours - published));
    lean_difference = std::max(lean_difference, std::abs(ours - lean));
  }
  const double timed = std::size(kTimed);
  table->AddTimes(fmt::format("the paper's grid, step 0.1, per node ({} nodes / {} timed)", grid.nodes, timed),
                  ours_s / nodes, published_s / timed, 10'000);
  table->AddTimes("... against point by point written for speed", ours_s / nodes, lean_s / timed, 0);
  table->AddTimes("... all nodes, with building the storeys (other: extrapolated)", ours_s + storey_s,
                  published_s / timed * nodes, 0);
  table->AddAtMost("... largest difference of S at the timed nodes, mm", "", "", fmt::format("{:.1e}", difference),
                   difference, 1e-9);
  table->Note(
      fmt::format("Grid: [110, 130] x [395, 425] mm, one thread. Point by point: eqs. (7)-(15), S between it and "
                  "the storeys differs by {:.1e} mm at most; written for speed (one pass, normal equations) it "
                  "differs by {:.1e} mm.",
                  difference, lean_difference));
}

}  // namespace scancal::bench
