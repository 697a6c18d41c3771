// The published search and the joint refinements on the same data, and the published figure of S.
#include <fmt/format.h>
#include <chrono>
#include <cmath>
#include "io/output_file.h"
#include "io/progress.h"
#include "models/turntable/turntable_scanner.h"

namespace scancal {
namespace {

constexpr double kSteps[] = {1, 0.1, 0.01};  // mm: the published one, and what finer ones bring
constexpr double kMostNodes = 1e8;           // about a minute
constexpr int kThreads = 2;

class Stopwatch {
 public:
  double Seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::vector<double> Values(const TurntablePose& pose) { return {pose.M, pose.N, pose.tilt_x, pose.tilt_y}; }

// Planes refitted at the pose: S as the search sees it, and the rms over all points.
struct Flatness {
  double S = 0, rms = 0;
};
Flatness FlatnessAt(const std::vector<Placement>& placements, const TurntablePose& pose, PlaneFit kind) {
  double sum = 0, squares = 0, points = 0;
  for (const Placement& placement : placements) {
    const PlaneStorey storey(Views(placement.profiles, Turntable::Residuals::kPlane), pose);
    sum += storey.Rmse(pose.M, pose.N, kind);
    squares += std::pow(storey.Rmse(pose.M, pose.N, PlaneFit::kOrthogonal), 2) * placement.Points();
    points += placement.Points();
  }
  return {sum / static_cast<double>(placements.size()), std::sqrt(squares / points)};
}

// Each placement seen with the pose that was found without it.
std::optional<double> HeldOutRms(const std::vector<Placement>& placements, const std::vector<TurntablePose>& without) {
  if (without.empty()) return std::nullopt;
  double squares = 0, points = 0;
  for (size_t t = 0; t < placements.size(); ++t) {
    squares += std::pow(FlatnessAt({placements[t]}, without[t], PlaneFit::kOrthogonal).rms, 2) * placements[t].Points();
    points += placements[t].Points();
  }
  return std::sqrt(squares / points);
}

ComparisonRow GridRow(const TurntableScanner& scanner, const TurntableStart& start, double step, PlaneFit kind) {
  const std::string name =
      fmt::format("grid, {}, step {:g}", kind == PlaneFit::kVertical ? "as published" : "orthogonal", step);
  Progress progress(name);
  GridBox box = scanner.Box();
  box.step = step;
  ComparisonRow row;
  row.method = name;
  row.is_grid = true;
  row.quantisation = step / std::sqrt(12.0);
  const auto [rows, columns] = box.Nodes();
  row.effort = static_cast<double>(rows) * static_cast<double>(columns);
  if (row.effort > kMostNodes) {
    row.note = fmt::format("left out: {:.2g} nodes", row.effort);
    return row;
  }
  const Stopwatch watch;
  const GridResult grid = GridSearch(
      box, static_cast<int>(start.storeys.size()),
      [&](const std::array<double, 2>& at, std::span<double> rmse) {
        for (size_t t = 0; t < rmse.size(); ++t) rmse[t] = start.storeys[t].Rmse(at[0], at[1], kind);
      },
      kThreads, [&](double fraction) { progress.Show(fraction); });
  row.seconds = watch.Seconds();
  TurntablePose pose = scanner.Nominal();
  pose.M = grid.best.at[0];
  pose.N = grid.best.at[1];
  row.values = Values(pose);
  row.u.resize(row.values.size());
  row.S = grid.best.value;
  row.rms = FlatnessAt(scanner.placements(), pose, kind).rms;
  if (grid.best.on_edge) row.note = "minimum on the edge";
  std::vector<TurntablePose> without(grid.without.size(), pose);
  for (size_t t = 0; t < without.size(); ++t) {
    without[t].M = grid.without[t].at[0];
    without[t].N = grid.without[t].at[1];
  }
  row.held_out_rms = HeldOutRms(scanner.placements(), without);
  return row;
}

TurntablePose Left(const TurntableScanner& scanner, const TurntableStart& start, Turntable::Residuals residuals,
                   bool weighted, const std::vector<int>& estimate, size_t out) {
  const TurntableFit fit = scanner.Fit(start.pose, residuals, estimate, out);
  return weighted ? scanner.FitWeighted(fit).Pose() : fit.Pose();
}

ComparisonRow JointRow(const TurntableScanner& scanner, const TurntableStart& start, const std::string& name,
                       Turntable::Residuals residuals, bool weighted, const std::vector<int>& estimate) {
  const Stopwatch watch;
  TurntableFit fit = scanner.Fit(start.pose, residuals, estimate);
  const bool determined = fit.solution.observability.undetermined.empty();
  if (weighted && determined) fit = scanner.FitWeighted(fit);
  ComparisonRow row;
  row.method = name;
  row.seconds = watch.Seconds();
  row.effort = fit.solution.fit.iterations;
  const TurntablePose pose = fit.Pose();
  row.values = Values(pose);
  row.u.resize(row.values.size());
  if (!determined) {
    row.note = "not determined: " + fit.solution.observability.undetermined.front();
  } else {
    for (const Parameter& parameter : Summarize(fit.solution, {}).parameters) {
      const int k = Find(fit.solution.problem.quantities, parameter.name);
      if (k <= Turntable::kTiltY && parameter.role == Role::kEstimate) row.u[k] = parameter.u;
    }
    if (!fit.solution.fit.converged) row.note = "no convergence";
  }
  const Flatness flatness = FlatnessAt(scanner.placements(), pose, PlaneFit::kOrthogonal);
  row.S = flatness.S;
  row.rms = flatness.rms;
  std::vector<TurntablePose> without;
  for (size_t t = 0; scanner.placements().size() > 1 && t < scanner.placements().size(); ++t)
    without.push_back(Left(scanner, start, residuals, weighted && determined, estimate, t));
  row.held_out_rms = HeldOutRms(scanner.placements(), without);
  return row;
}

}  // namespace

Result<Comparison> TurntableScanner::Compare() const {
  SCANCAL_ASSIGN_OR_RETURN(const TurntableStart start, Initialize());
  Comparison comparison{{"M", "N", "tilt_x", "tilt_y"}, {false, false, true, true}, {}};
  for (const PlaneFit kind : {PlaneFit::kVertical, PlaneFit::kOrthogonal})
    for (const double step : kSteps) comparison.rows.push_back(GridRow(*this, start, step, kind));
  using enum Turntable::Residuals;
  comparison.rows.push_back(JointRow(*this, start, "joint, point to plane", kPlane, false, {}));
  comparison.rows.push_back(JointRow(*this, start, "joint, depth", kDepth, false, {}));
  comparison.rows.push_back(
      JointRow(*this, start, "joint, depth, weighted, tilts", kDepth, true, {Turntable::kTiltX, Turntable::kTiltY}));
  comparison.rows.push_back(JointRow(*this, start, "joint, depth, weighted", kDepth, true, {}));
  return comparison;
}

Result<void> TurntableScanner::WriteSurface(const std::filesystem::path& file) const {
  SCANCAL_ASSIGN_OR_RETURN(const TurntableStart start, Initialize());
  SCANCAL_ASSIGN_OR_RETURN(OutputFile output, OutputFile::Create(file));
  SCANCAL_RETURN_IF_ERROR(output.Write("M_mm,N_mm,S_published_mm,S_orthogonal_mm\n"));
  const GridBox box = Box();
  const auto [rows, columns] = box.Nodes();
  const double targets = static_cast<double>(start.storeys.size());
  for (int64_t i = 0; i < rows; ++i) {
    for (int64_t j = 0; j < columns; ++j) {
      const auto [M, N] = box.At(i, j);
      double published = 0, orthogonal = 0;
      for (const PlaneStorey& storey : start.storeys) {
        published += storey.Rmse(M, N, PlaneFit::kVertical) / targets;
        orthogonal += storey.Rmse(M, N, PlaneFit::kOrthogonal) / targets;
      }
      SCANCAL_RETURN_IF_ERROR(
          output.Write(fmt::format("{:.10g},{:.10g},{:.10g},{:.10g}\n", M, N, published, orthogonal)));
    }
  }
  return output.Commit();
}

}  // namespace scancal
