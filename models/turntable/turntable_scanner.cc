#include "models/turntable/turntable_scanner.h"
#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include "io/progress.h"
#include "models/turntable/residual_tables.h"
#include "models/turntable/scene.h"
#include "models/turntable/surface.h"
#include "models/turntable/verdicts.h"
#include "models/turntable/volume.h"

namespace scancal {

using turntable::System;

namespace {

constexpr int kRoundsOfReading = 4;

constexpr double kNodesOfReading = 60;  // a side

System DeclaredOf(const Turntable& model) {
  System system;
  for (size_t k = 0; k < system.q.size(); ++k) system[k] = model.quantities()[k].value;
  return system;
}

bool SamePoints(const std::vector<Placement>& a, const std::vector<Placement>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Placement& x, const Placement& y) { return x.Points() == y.Points(); });
}

GridBox BoxOf(const TurntableDeclaration& declaration, const Turntable& model) {
  GridBox box = declaration.search;
  for (size_t k = 0; k < 2; ++k) {
    const Quantity& quantity = model.quantities()[k == 0 ? Turntable::kM : Turntable::kN];
    if (quantity.role != Role::kEstimate) box.lower[k] = box.upper[k] = quantity.value;
  }
  return box;
}

// The same box with fewer nodes, if it has many: enough to begin a refinement.
GridBox Coarse(GridBox box) {
  const double longest = std::max(box.upper[0] - box.lower[0], box.upper[1] - box.lower[1]);
  box.step = std::max(box.step, longest / kNodesOfReading);
  return box;
}

System MiddleOf(const GridBox& box, const System& system) {
  return system.With((box.lower[0] + box.upper[0]) / 2, (box.lower[1] + box.upper[1]) / 2);
}

std::array<double, 2> DepthsOf(const std::vector<RawScan>& scans) {
  std::array<double, 2> depths = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const RawScan& scan : scans)
    for (const RawProfile& profile : scan.profiles)
      for (const double y : profile.y) depths = {std::min(depths[0], y), std::max(depths[1], y)};
  return depths;
}

GridResult Search(const GridBox& box, const std::vector<PlaneStorey>& storeys) {
  Progress progress("searching M, N");
  const auto rmse = [&](const std::array<double, 2>& at, std::span<double> values) {
    for (size_t t = 0; t < values.size(); ++t) values[t] = storeys[t].Rmse(at[0], at[1], PlaneFit::kOrthogonal);
  };
  return GridSearch(box, static_cast<int>(storeys.size()), rmse, 2, [&](double done) { progress.Show(done); });
}

}  // namespace

TurntableScanner::TurntableScanner(TurntableDeclaration declaration, Turntable model, std::vector<Placement> placements)
    : declaration_(std::move(declaration)), model_(std::move(model)), placements_(std::move(placements)) {}

GridBox TurntableScanner::Box() const { return BoxOf(declaration_, model_); }

System TurntableScanner::Declared() const {
  System system = DeclaredOf(model_);
  system.depths = VolumeOf(placements_).y;
  return system;
}

const Result<TurntableStart>& TurntableScanner::Start() const {
  if (!start_) start_ = StartIn(Box());
  return *start_;
}

Result<TurntableStart> TurntableScanner::StartIn(const GridBox& box) const {
  TurntableStart start;
  const System declared = Declared(), middle = MiddleOf(Box(), declared);
  start.storeys = StoreysOf(placements_, declared);
  SCANCAL_RETURN_IF_ERROR(CheckOrientations(model_.quantities(), placements_, start.storeys, middle));
  start.grid = Search(box, start.storeys);
  start.system = declared.With(start.grid.best.at[0], start.grid.best.at[1]);
  // The noise of a lidar can pull the minimum of S far away. The middle of the interval is free of that, and two starts
  // that end in one place are no local minimum.
  double least = std::numeric_limits<double>::infinity();
  for (const System& from : {System(start.system), middle}) {
    const TurntableFit fit = Fit(from, Turntable::Residuals::kDepth);
    if (!(fit.solution.fit.cost < least) || !CheckDetermined(fit).ok()) continue;
    least = fit.solution.fit.cost;
    start.system = fit.Found();
  }
  SCANCAL_RETURN_IF_ERROR(CheckIncidence(placements_, start.system));
  return start;
}

// The search as it would be, had the data set declared what was found besides M and N: only its minimum is comparable.
GridResult TurntableScanner::SearchKnowing(const System& found, const TurntableStart& start) const {
  const bool as_declared = Declared().With(found.M(), found.N()).q == found.q;
  return as_declared ? start.grid : Search(Box(), StoreysOf(placements_, found));
}

Result<Calibration> TurntableScanner::Calibrate(const RefineChoice& choice) const {
  const bool plane = choice.residual == "plane";
  if (!plane && !choice.residual.empty() && choice.residual != "depth")
    return Error{"residual: found \"" + choice.residual + "\", expected depth or plane"};
  const bool weighted = !plane && !choice.equal_weights;
  if (!weighted && choice.monte_carlo.trials > 0)
    return Error{"montecarlo: found equal weights, expected estimated ones: only they say how large all noise is"};
  SCANCAL_ASSIGN_OR_RETURN(const TurntableStart start, Start());
  const auto began = std::chrono::steady_clock::now();
  TurntableFit fit = Fit(start.system, plane ? Turntable::Residuals::kPlane : Turntable::Residuals::kDepth, {}, {},
                         choice.max_iterations);
  SCANCAL_RETURN_IF_ERROR(CheckDetermined(fit));
  if (weighted) fit = FitWeighted(fit, choice.max_iterations);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;

  // Within a profile the plain residual repeats as the depth does, seen at an angle: its pure error is not comparable.
  Calibration result = Summarize(fit.solution, plane ? PureError{} : PureOf(placements_));
  result.lack_of_fit.pure_error_sigma = PureOf(placements_).sigma();
  Progress progress("Monte Carlo");
  AddResampling(
      fit.solution, choice.monte_carlo, [&](double done) { progress.Show(done); }, &result);
  result.model = kTurntable.name;
  result.name = declaration_.dataset.name;
  result.residual = plane ? "plane" : "depth";
  result.seconds = seconds.count();
  const GridBox box = Box();
  result.grid = {{"M", "N"},
                 {start.grid.best.at[0], start.grid.best.at[1]},
                 start.grid.best.value,
                 box.step,
                 static_cast<double>(start.grid.nodes)};
  const System found = fit.Found();
  for (size_t t = 0; t < result.targets.size(); ++t) {
    TargetSummary& target = result.targets[t];
    const std::vector<double> values = Values(fit.solution.problem, fit.solution.fit.estimate, t);
    target.residual_tables = ResidualTables({placements_[t], fit.targets[t], values, found});
    target.missing = placements_[t].missing;
    target.set_aside = placements_[t].set_aside;
    target.residuals = ResidualsOf(placements_[t]);
    const auto [normal, distance] = fit.Plane(t);
    target.geometry = {{"normal", {normal[0], normal[1], normal[2]}}, {"distance", {distance}}};
  }
  result.warnings.insert(result.warnings.begin(), declaration_.warnings.begin(), declaration_.warnings.end());
  if (plane)
    result.warnings.push_back(
        "point-to-plane residuals are biased by the noise along depth; the depth residual is not");
  JudgeTurntable(box, placements_, SearchKnowing(found, start), fit, &result);
  AddVolume(placements_, &result);
  AddSurface(box, start.storeys, StoreysOf(placements_, found), &result);
  AddScene(placements_, &result);
  return result;
}

Result<std::unique_ptr<Scanner>> LoadTurntable(const Dataset& dataset) {
  Turntable model(Turntable::Residuals::kDepth);
  SCANCAL_ASSIGN_OR_RETURN(TurntableDeclaration declaration, DeclareTurntable(dataset, &model));
  std::vector<RawScan> scans;
  for (const ScanDeclaration& scan : declaration.scans) {
    SCANCAL_ASSIGN_OR_RETURN(RawScan raw, ReadCleanScan(scan, declaration.sense));
    if (!raw.warning.empty()) declaration.warnings.push_back(raw.warning);
    scans.push_back(std::move(raw));
  }
  SCANCAL_ASSIGN_OR_RETURN(std::unique_ptr<TurntableScanner> scanner, CompressTurntable(declaration, model, scans));
  return std::unique_ptr<Scanner>(std::move(scanner));
}

// Setting aside needs M and N, finding them needs clean points: in turn, until nothing changes. The first round is in
// the middle of the search interval; a coarse search begins the same refinement as the declared one.
Result<std::unique_ptr<TurntableScanner>> CompressTurntable(const TurntableDeclaration& declaration,
                                                            const Turntable& model, const std::vector<RawScan>& scans) {
  std::unique_ptr<TurntableScanner> scanner;
  const GridBox box = BoxOf(declaration, model);
  System system = MiddleOf(box, DeclaredOf(model));
  system.depths = DepthsOf(scans);
  for (int round = 0; round < kRoundsOfReading; ++round) {
    std::vector<Placement> placements;
    for (const RawScan& scan : scans) placements.push_back(CompressPlacement(scan, system));
    if (scanner && SamePoints(placements, scanner->placements())) break;
    SCANCAL_RETURN_IF_ERROR(CheckPlausible(placements, declaration.dataset.units));
    scanner = std::make_unique<TurntableScanner>(declaration, model, std::move(placements));
    const Result<TurntableStart> start = scanner->StartIn(Coarse(box));
    if (!start.ok()) break;  // Calibrate will say so
    system = start->system;
  }
  return scanner;
}

std::vector<std::filesystem::path> TurntableScanner::Files() const {
  std::vector<std::filesystem::path> files = {declaration_.dataset.file};
  for (const ScanDeclaration& scan : declaration_.scans)
    if (std::find(files.begin(), files.end(), scan.format.path) == files.end()) files.push_back(scan.format.path);
  return files;
}

std::string TurntableScanner::Describe() const {
  const Dataset& dataset = declaration_.dataset;
  const GridBox& box = declaration_.search;
  double profiles = 0, points = 0, missing = 0, off = 0;
  for (const Placement& placement : placements_) {
    profiles += static_cast<double>(placement.profiles.size());
    points += placement.Points();
    missing += placement.missing;
    for (const auto& [reason, count] : placement.set_aside) off += count;
  }
  return fmt::format(
      "{}: turntable, lengths in {}, angles in {}, table seen to turn {} from +Z; {} targets, {} profiles, {} points "
      "used, {} "
      "missing, {} set aside; M searched from {:g} to {:g} mm, N from {:g} to {:g} mm.",
      dataset.name.empty() ? dataset.file.parent_path().filename().string() : dataset.name, dataset.units.length,
      dataset.units.angle, declaration_.sense > 0 ? "clockwise" : "counterclockwise", placements_.size(), profiles,
      points, missing, off, box.lower[0], box.upper[0], box.lower[1], box.upper[1]);
}

}  // namespace scancal
