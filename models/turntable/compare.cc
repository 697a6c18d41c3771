// The published search and the joint refinements on the same data.
#include <array>
#include <cmath>
#include "models/turntable/scanner.h"
#include "solver/calibrate.h"

namespace scancal::turntable {
namespace {

constexpr Message<Sentence, double> kGrid{"turntable.grid", "grid, {}, step {:g}", "Gitter, {}, Schritt {:g}"};
constexpr Message<> kAsPublished{"turntable.as_published", "as published", "veröffentlicht"};
constexpr Message<> kOrthogonalFit{"turntable.orthogonal_fit", "orthogonal", "orthogonal"};
constexpr Message<> kJointPlane{"turntable.joint_plane", "joint, point to plane", "gemeinsam, Punkt–Ebene"};
constexpr Message<> kJointDepth{"turntable.joint_depth", "joint, depth", "gemeinsam, Tiefe"};
constexpr Message<> kJointTilts{"turntable.joint_tilts", "joint, depth, weighted, tilts",
                                "gemeinsam, Tiefe, gewichtet, Kippung"};
constexpr Message<> kJointWeighted{"turntable.joint_weighted", "joint, depth, weighted", "gemeinsam, Tiefe, gewichtet"};
constexpr Message<double> kTooManyNodes{"turntable.too_many_nodes", "left out: {:.2g} nodes",
                                        "weggelassen: {:.2g} Knoten"};
constexpr Message<> kOnEdge{"turntable.on_edge", "minimum on the edge", "Minimum am Rand"};
constexpr Message<std::string_view> kUndetermined{"turntable.undetermined", "not determined: {}", "nicht bestimmt: {}"};
constexpr Message<> kUnconverged{"turntable.unconverged", "no convergence", "keine Konvergenz"};

constexpr double kMostNodes = 1e8;   // about a minute
constexpr double kFewPlanes = 2e6;   // fitted on a grid: as long as a refinement
constexpr double kFewLeftOut = 2e4;  // profiles refitted with each placement left out

constexpr size_t kParameters = 4;
std::vector<double> Values(const System& system) {
  return {system.q.begin(), system.q.begin() + kParameters};  // M, N, tilt_x, tilt_y
}

struct MethodResult {
  Sentence method, note;
  std::vector<double> values;           // mm, rad; empty: left out
  std::array<double, kParameters> u{};  // 0: none
  std::optional<double> quantisation;   // of a grid: step / sqrt(12), mm
  double S = 0;                         // the search's objective, mm
  double rms = 0;                       // of the distance that all methods make small, mm
  std::optional<double> held_out_rms;   // of each placement with the values found without it, pooled, mm
  double effort = 0;                    // nodes of a grid, iterations of a refinement
  double seconds = 0;
};

// The last one is the reference.
Comparison Tabulate(const std::vector<MethodResult>& results) {
  Comparison table{{{"M/mm", 6},
                    {"N/mm", 6},
                    {"tilt_x/mrad", 3, false, true},
                    {"tilt_y/mrad", 3, false, true},
                    {"S/um"},
                    {"plane rms/um", 3, false, true},
                    {"held out/um"},
                    {"u(M)/um", 3, false, true},
                    {"u(N)/um", 3, false, true},
                    {"step/√12/um", 3, false, true},
                    {"ΔM/u"},
                    {"ΔN/u"},
                    {"nodes, iter.", 0, false, true},
                    {"s", 2, true}},
                   {}};
  const MethodResult& reference = results.back();
  const auto um = [](std::optional<double> mm) { return ComparisonCell{mm ? std::optional(*mm * 1000) : mm}; };
  const auto positive = [](double u) { return u > 0 ? std::optional(u) : std::nullopt; };
  for (const MethodResult& result : results) {
    ComparisonRow& row = table.rows.emplace_back(ComparisonRow{result.method, {}, result.note});
    if (result.values.empty()) continue;
    for (const size_t k : {0, 1}) row.cells.push_back({result.values[k], result.u[k]});
    for (const size_t k : {2, 3}) row.cells.push_back({result.values[k] * 1000});
    row.cells.push_back(um(result.S));
    row.cells.push_back(um(result.rms));
    row.cells.push_back(um(result.held_out_rms));
    for (const size_t k : {0, 1}) row.cells.push_back(um(positive(result.u[k])));
    row.cells.push_back(um(result.quantisation));
    for (const size_t k : {0, 1})
      row.cells.push_back({reference.u[k] > 0 ? std::optional((result.values[k] - reference.values[k]) / reference.u[k])
                                              : std::nullopt});
    row.cells.push_back({result.effort});
    row.cells.push_back({result.seconds});
  }
  return table;
}

// Planes refitted to the points as the system sees them: S as the search sees it, and the rms over all points.
struct Flatness {
  double S = 0, rms = 0;
};
Flatness FlatnessOf(const std::vector<Placement>& placements, const System& system, PlaneFit kind) {
  double sum = 0, squares = 0, points = 0;
  for (const Placement& placement : placements) {
    const PlaneStorey storey(placement.profiles, system);
    sum += storey.Rmse(system.M(), system.N(), kind);
    squares += std::pow(storey.Rmse(system.M(), system.N(), PlaneFit::kOrthogonal), 2) * placement.Points();
    points += placement.Points();
  }
  return {sum / static_cast<double>(placements.size()), std::sqrt(squares / points)};
}

// Each placement as it is seen by what was found without it.
std::optional<double> HeldOutRms(const std::vector<Placement>& placements, const std::vector<System>& without) {
  if (without.empty()) return std::nullopt;
  double squares = 0, points = 0;
  for (size_t t = 0; t < placements.size(); ++t) {
    squares += std::pow(FlatnessOf({placements[t]}, without[t], PlaneFit::kOrthogonal).rms, 2) * placements[t].Points();
    points += placements[t].Points();
  }
  return std::sqrt(squares / points);
}

MethodResult GridRow(const Scanner& scanner, const Start& start, double step, PlaneFit kind,
                     const CompareChoice& choice) {
  const Sentence name = Say(kGrid, Say(kind == PlaneFit::kVertical ? kAsPublished : kOrthogonalFit), step);
  GridBox box = scanner.Box();
  box.step = step;
  MethodResult row;
  row.method = name;
  row.quantisation = step / std::sqrt(12.0);
  const auto [rows, columns] = box.Nodes();
  row.effort = static_cast<double>(rows) * static_cast<double>(columns);
  const double most = choice.brief ? kFewPlanes / static_cast<double>(start.storeys.size()) : kMostNodes;
  if (row.effort > most) {
    row.note = Say(kTooManyNodes, row.effort);
    return row;
  }
  const Stopwatch watch;
  const GridResult grid = Search(box, start.storeys, kind, name);
  row.seconds = watch.Seconds();
  const System declared = scanner.Declared();
  const auto with = [&](const GridNode& node) { return declared.With(node.at[0], node.at[1]); };
  const System best = with(grid.best);
  row.values = Values(best);
  row.S = grid.best.value;
  row.rms = FlatnessOf(scanner.placements(), best, kind).rms;
  if (grid.best.on_edge) row.note = Say(kOnEdge);
  std::vector<System> without;
  for (const GridNode& node : grid.without) without.push_back(with(node));
  row.held_out_rms = HeldOutRms(scanner.placements(), without);
  return row;
}

System FoundWithout(const Scanner& scanner, const Start& start, Model::Residuals residuals, bool weighted,
                    const std::vector<int>& estimate, size_t out) {
  const JointFit fit = scanner.Fit(start.system, residuals, {.estimate = estimate, .without = out});
  return weighted ? scanner.FitWeighted(fit).Found() : fit.Found();
}

bool HoldsOut(const std::vector<Placement>& placements, const CompareChoice& choice) {
  size_t profiles = 0;
  for (const Placement& placement : placements) profiles += placement.profiles.size();
  const auto refitted = static_cast<double>(profiles * placements.size());
  return placements.size() > 1 && (!choice.brief || refitted <= kFewLeftOut);
}

MethodResult JointRow(const Scanner& scanner, const Start& start, const Sentence& name, Model::Residuals residuals,
                      bool weighted, const std::vector<int>& estimate, const CompareChoice& choice) {
  const Stopwatch watch;
  JointFit fit = scanner.Fit(start.system, residuals, {.estimate = estimate});
  const bool determined = fit.solution.observability.undetermined.empty();
  if (weighted && determined) fit = scanner.FitWeighted(fit);
  MethodResult row;
  row.method = name;
  row.seconds = watch.Seconds();
  row.effort = fit.solution.fit.iterations;
  const System found = fit.Found();
  row.values = Values(found);
  if (!determined) {
    row.note = Say(kUndetermined, fit.solution.observability.undetermined.front());
  } else {
    const Problem& problem = fit.solution.problem;
    const Headline headline = HeadlineOf(fit.solution, ClusteredCovariance(problem, fit.solution.linear));
    Eigen::Index e = 0;
    for (const int k : problem.With({Scope::kSystem}, Role::kEstimate)) {
      if (k <= Model::kTiltY) row.u[static_cast<size_t>(k)] = std::sqrt(headline.covariance(e, e));
      ++e;
    }
    if (!fit.solution.fit.converged) row.note = Say(kUnconverged);
  }
  const Flatness flatness = FlatnessOf(scanner.placements(), found, PlaneFit::kOrthogonal);
  row.S = flatness.S;
  row.rms = flatness.rms;
  std::vector<System> without;
  for (size_t t = 0; HoldsOut(scanner.placements(), choice) && t < scanner.placements().size(); ++t)
    without.push_back(FoundWithout(scanner, start, residuals, weighted && determined, estimate, t));
  row.held_out_rms = HeldOutRms(scanner.placements(), without);
  return row;
}

}  // namespace

Result<Comparison> Scanner::Compare(const CompareChoice& choice) const {
  SCANCAL_ASSIGN_OR_RETURN(const Start start, FindStart());
  std::vector<MethodResult> results;
  for (const PlaneFit kind : {PlaneFit::kVertical, PlaneFit::kOrthogonal})
    for (const double step : choice.steps) results.push_back(GridRow(*this, start, step, kind, choice));
  using enum Model::Residuals;
  results.push_back(JointRow(*this, start, Say(kJointPlane), kPlane, false, {}, choice));
  results.push_back(JointRow(*this, start, Say(kJointDepth), kDepth, false, {}, choice));
  results.push_back(JointRow(*this, start, Say(kJointTilts), kDepth, true, {Model::kTiltX, Model::kTiltY}, choice));
  results.push_back(JointRow(*this, start, Say(kJointWeighted), kDepth, true, {}, choice));
  return Tabulate(results);
}

}  // namespace scancal::turntable
