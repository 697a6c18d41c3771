#include <fmt/format.h>
#include <glog/logging.h>
#include <algorithm>
#include <cmath>
#include <optional>
#include "tests/bench/comparisons.h"
#include "tests/bench/per_point.h"
#include "tests/bench/scipy.h"

namespace scancal::bench {
namespace {

using Residuals = turntable::Model::Residuals;

struct Ours {
  Problem problem;
  Fit fit;
  std::vector<double> refine_s;  // timed three times, between the long runs of the others
  double build_s = 0, compress_s = 0;
  double peak_mb = 0;
};

void TimeRefine(const LargeData& data, Ours* ours) {
  const Estimate from = StartOf(ours->problem, data.start);
  ours->refine_s.push_back(MedianSecondsOf([&] { ours->fit = Refine(ours->problem, from); }));
  std::sort(ours->refine_s.begin(), ours->refine_s.end());
}

double RefineSeconds(const Ours& ours) { return ours.refine_s[ours.refine_s.size() / 2]; }

Ours Solve(const LargeData& data, Residuals residuals) {
  Ours ours;
  ours.problem = BuildProblem(data.placements, data.start, residuals);
  TimeRefine(data, &ours);
  ours.build_s = MedianSecondsOf([&] { BuildProblem(data.placements, data.start, residuals); });
  ours.compress_s = MedianSecondsOf([&] { Compress(data.points); });
  const ChildRun child = RunInChild([&] {
    const std::vector<Placement> placements = Compress(data.points);
    const Problem again = BuildProblem(placements, data.start, residuals);
    return std::vector{Refine(again, StartOf(again, data.start)).cost};
  });
  CHECK_LE(std::abs(child.values.at(0) / ours.fit.cost - 1), 1e-12);
  ours.peak_mb = child.peak_mb;
  return ours;
}

struct PerPoint {
  PerPointFit fit, polished;
  double peak_mb = 0;
};

PerPoint SolvePerPoint(const LargeData& data, Residuals residuals) {
  const ChildRun child = RunInChild([&] {
    const PerPointFit fit = FitPerPoint(data.points, data.start, residuals);
    std::vector<double> values = {fit.M,       fit.N,       fit.cost,
                                  fit.build_s, fit.solve_s, static_cast<double>(fit.iterations)};
    values.insert(values.end(), fit.planes.begin(), fit.planes.end());
    return values;
  });
  const std::vector<double>& v = child.values;
  PerPoint result;
  result.fit = {v.at(0), v.at(1), v.at(2), {v.begin() + 6, v.end()}, v.at(3), v.at(4), static_cast<int>(v.at(5))};
  result.peak_mb = child.peak_mb;
  result.polished = result.fit;
  Polish(data.points, data.start, residuals, &result.polished);
  return result;
}

std::string Megabytes(double mb) { return fmt::format("{:.3g} MB", mb); }

double Distance(const Fit& ours, double M, double N) {
  return std::max(std::abs(ours.estimate.system[0] - M), std::abs(ours.estimate.system[1] - N));
}

void AddCeres(const std::string& name, const Ours& ours, const PerPoint& other, double at_least, Table* table) {
  table->AddTimes(name + ": solve, against Ceres per point", RefineSeconds(ours), other.fit.solve_s, at_least);
  table->AddTimes("... with building the problem", RefineSeconds(ours) + ours.build_s,
                  other.fit.solve_s + other.fit.build_s, 0);
  table->AddTimes("... from points in memory: compression, building, solve",
                  ours.compress_s + RefineSeconds(ours) + ours.build_s, other.fit.solve_s + other.fit.build_s, 0);
  const double memory = other.peak_mb / ours.peak_mb;
  table->Add({"... memory beyond the points", Megabytes(ours.peak_mb), Megabytes(other.peak_mb), Ratio(memory),
              "more than 50", memory > 50 ? "yes" : "NO"});
  const double apart = Distance(ours.fit, other.polished.M, other.polished.N);
  table->AddAtMost("... same M, N (mm; other: Ceres, then polished)",
                   fmt::format("{:.9f}, {:.9f}", ours.fit.estimate.system[0], ours.fit.estimate.system[1]),
                   fmt::format("{:.9f}, {:.9f}", other.polished.M, other.polished.N), fmt::format("{:.1e}", apart),
                   apart, 1e-8);
  const double cost = std::abs(ours.fit.cost / other.polished.cost - 1);
  table->AddAtMost("... same sum of squares (mm2; relative)", fmt::format("{:.6f}", ours.fit.cost),
                   fmt::format("{:.6f}", other.polished.cost), fmt::format("{:.1e}", cost), cost, 1e-9);
  table->Note(fmt::format(
      "{}: Ceres stopped after {} iterations, {:.1e} mm from M, N here, and three Gauss-Newton steps "
      "by QR over all points (not timed) took it to {:.1e} mm; ours took {} iterations.",
      name, other.fit.iterations, Distance(ours.fit, other.fit.M, other.fit.N), apart, ours.fit.iterations));
}

void AddScipy(const std::string& name, const Ours& ours, const ScipyFit& other, double at_least, Table* table) {
  table->AddTimes(name + ": solve, against scipy least_squares", RefineSeconds(ours), other.seconds, at_least);
  table->Add({"... memory beyond the points", Megabytes(ours.peak_mb), Megabytes(other.peak_mb),
              Ratio(other.peak_mb / ours.peak_mb), "", ""});
  const double apart = Distance(ours.fit, other.M, other.N);
  const double cost = std::abs(ours.fit.cost / other.cost - 1);
  table->AddAtMost("... same M, N (mm; as scipy left it)",
                   fmt::format("{:.9f}, {:.9f}", ours.fit.estimate.system[0], ours.fit.estimate.system[1]),
                   fmt::format("{:.9f}, {:.9f}", other.M, other.N), fmt::format("{:.1e}", apart), apart, 1e-6);
  table->Note(
      fmt::format("{}: scipy {} ({}), {} calls of the residuals besides those of its Jacobian, relative "
                  "difference of the sum of squares {:.1e}.",
                  name, other.version, other.method, other.calls, cost));
}

}  // namespace

void CompareJoint(const LargeData& data, const std::filesystem::path& scipy_script, const std::filesystem::path& folder,
                  Table* table) {
  if (!scipy_script.empty()) WriteForScipy(data, folder);
  for (const Residuals residuals : {Residuals::kPlane, Residuals::kDepth}) {
    const bool plane = residuals == Residuals::kPlane;
    const std::string name = plane ? "plain joint fit" : "depth-residual joint fit";
    const double at_least = plane ? 10'000 : 1'000;
    Say(name + ": ours");
    Ours ours = Solve(data, residuals);
    Say(name + ": Ceres, one residual per point (half a minute)");
    const PerPoint ceres = SolvePerPoint(data, residuals);
    TimeRefine(data, &ours);
    std::optional<ScipyFit> scipy;
    if (!scipy_script.empty()) {
      Say(name + ": scipy.optimize.least_squares (half a minute)");
      scipy = RunScipy(scipy_script, folder, plane ? "plane" : "depth");
    }
    TimeRefine(data, &ours);
    AddCeres(name, ours, ceres, at_least, table);
    if (scipy) AddScipy(name, ours, *scipy, at_least, table);
  }
}

}  // namespace scancal::bench
