#include "models/turntable/turntable_scanner.h"
#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include "io/progress.h"
#include "models/turntable/off_plane.h"
#include "models/turntable/verdicts.h"

namespace scancal {
namespace {

constexpr int kRoundsOfSettingAside = 4;
const char kReasonOffPlane[] = "on a profile off the plane of its target";

TurntablePose PoseOf(const Quantities& quantities) {
  return {quantities[Turntable::kM].value,      quantities[Turntable::kN].value,
          quantities[Turntable::kTiltX].value,  quantities[Turntable::kTiltY].value,
          quantities[Turntable::kScaleY].value, quantities[Turntable::kScaleZ].value};
}

std::vector<PlaneStorey> Storeys(const std::vector<Placement>& placements, const TurntablePose& tilts) {
  std::vector<PlaneStorey> storeys;
  for (const Placement& placement : placements)
    storeys.emplace_back(Views(placement.profiles, Turntable::Residuals::kPlane), tilts);
  return storeys;
}

// The placements without the profiles that are off their plane at `pose`, counted.
std::vector<Placement> SetAsideOffPlane(const std::vector<Placement>& all, const TurntablePose& pose) {
  std::vector<Placement> kept;
  for (const Placement& placement : all) {
    const std::vector<bool> off = OffPlane(placement.profiles, pose);
    Placement& rest = kept.emplace_back(placement);
    rest.profiles.clear();
    double removed = 0;
    for (size_t k = 0; k < off.size(); ++k) {
      if (off[k]) {
        removed += placement.profiles[k].count;
      } else {
        rest.profiles.push_back(placement.profiles[k]);
      }
    }
    if (removed > 0) rest.set_aside[kReasonOffPlane] = removed;
  }
  return kept;
}

PureError Pooled(const std::vector<Placement>& placements) {
  PureError sum;
  for (const Placement& placement : placements) {
    for (const Profile& profile : placement.profiles) {
      sum.sum_of_squares += profile.pure_error.sum_of_squares;
      sum.dof += profile.pure_error.dof;
    }
  }
  return sum;
}

}  // namespace

TurntableScanner::TurntableScanner(TurntableDeclaration declaration, Turntable model, std::vector<Placement> placements)
    : declaration_(std::move(declaration)), model_(std::move(model)), placements_(std::move(placements)) {}

GridBox TurntableScanner::Box() const {
  GridBox box = declaration_.search;
  for (size_t k = 0; k < 2; ++k) {
    const Quantity& quantity = model_.quantities()[k == 0 ? Turntable::kM : Turntable::kN];
    if (quantity.role != Role::kEstimate) box.lower[k] = box.upper[k] = quantity.value;
  }
  return box;
}

Result<TurntableStart> TurntableScanner::Initialize() const {
  TurntableStart start;
  start.placements = placements_;
  start.pose = PoseOf(model_.quantities());
  Progress progress("searching M, N");
  for (int round = 0; round < kRoundsOfSettingAside; ++round) {
    start.storeys = Storeys(start.placements, start.pose);
    const auto rmse = [&](const std::array<double, 2>& at, std::span<double> values) {
      for (size_t t = 0; t < values.size(); ++t) values[t] = start.storeys[t].Rmse(at[0], at[1], PlaneFit::kOrthogonal);
    };
    start.grid = GridSearch(Box(), static_cast<int>(start.storeys.size()), rmse, 2,
                            [&](double fraction) { progress.Show(fraction); });
    start.pose.M = start.grid.best.at[0];
    start.pose.N = start.grid.best.at[1];
    std::vector<Placement> next = SetAsideOffPlane(placements_, start.pose);
    const bool same = std::equal(next.begin(), next.end(), start.placements.begin(),
                                 [](const auto& a, const auto& b) { return a.profiles.size() == b.profiles.size(); });
    if (same) break;
    start.placements = std::move(next);
  }
  start.storeys = Storeys(start.placements, start.pose);
  SCANCAL_RETURN_IF_ERROR(CheckOrientations(model_.quantities(), start));
  return start;
}

TurntableFit TurntableScanner::Fit(const TurntableStart& start, Turntable::Residuals residuals,
                                   const std::vector<int>& estimate, int max_iterations) const {
  TurntableFit fit;
  const double pure = Pooled(start.placements).sigma();
  fit.sigma = residuals == Turntable::Residuals::kDepth && pure > 0 ? pure : std::max(start.grid.best.value, 1e-9);
  const auto model = std::make_shared<Turntable>(residuals);
  for (int k = 0; k < std::ssize(model_.quantities()); ++k) model->quantity(k) = model_.quantities()[k];
  for (const int k : estimate) model->quantity(k).role = Role::kEstimate;
  Quantity& noise = model->quantity(Turntable::kNoiseY);
  if (noise.role != Role::kConsider) noise.u = fit.sigma;
  noise.role = Role::kConsider;

  for (size_t t = 0; t < start.placements.size(); ++t) {
    Turntable::Target& target = fit.targets.emplace_back();
    target.name = start.placements[t].name;
    target.views = Views(start.placements[t].profiles, residuals);
    const auto [normal, distance] = start.storeys[t].FitPlane(start.pose.M, start.pose.N);
    Turntable::SetPlane(normal, distance, &target);
  }
  Problem problem = MakeProblem<Turntable>(model, fit.targets);
  problem.WeighEqually(fit.sigma);
  Estimate from = NominalStart(problem);
  Eigen::Index e = 0;
  for (const int k : problem.With({Scope::kSystem}, Role::kEstimate)) {
    if (k == Turntable::kM) from.system[e] = start.pose.M;
    if (k == Turntable::kN) from.system[e] = start.pose.N;
    ++e;
  }
  fit.solution = Solve(std::move(problem), from, {max_iterations});
  return fit;
}

TurntablePose TurntableFit::Pose() const {
  Quantities quantities = solution.problem.quantities;
  const std::vector<double> values = Values(solution.problem, solution.fit.estimate, 0);
  for (size_t k = 0; k < quantities.size(); ++k) quantities[k].value = values[k];
  return PoseOf(quantities);
}

std::pair<Eigen::Vector3d, double> TurntableFit::Plane(size_t target) const {
  auto [normal, distance] = Turntable::Plane(targets[target], solution.fit.estimate.targets[target]);
  if (distance >= 0) return {normal, distance};
  return {-normal, -distance};
}

Result<Calibration> TurntableScanner::Calibrate(const RefineChoice& choice) const {
  const bool plane = choice.residual == "plane";
  if (!plane && !choice.residual.empty() && choice.residual != "depth")
    return Error{"residual: found \"" + choice.residual + "\", expected depth or plane"};
  SCANCAL_ASSIGN_OR_RETURN(const TurntableStart start, Initialize());
  const auto began = std::chrono::steady_clock::now();
  const TurntableFit fit =
      Fit(start, plane ? Turntable::Residuals::kPlane : Turntable::Residuals::kDepth, {}, choice.max_iterations);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;
  SCANCAL_RETURN_IF_ERROR(CheckDetermined(fit));

  // Within a profile the plain residual repeats as the depth does, seen at an angle: its pure error is not comparable.
  Calibration result = Summarize(fit.solution, fit.sigma, plane ? PureError{} : Pooled(start.placements));
  result.lack_of_fit.pure_error_sigma = Pooled(start.placements).sigma();
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
  for (size_t t = 0; t < result.targets.size(); ++t) {
    TargetSummary& target = result.targets[t];
    target.missing = start.placements[t].missing;
    target.set_aside = start.placements[t].set_aside;
    const auto [normal, distance] = fit.Plane(t);
    target.geometry = {{"normal", {normal[0], normal[1], normal[2]}}, {"distance", {distance}}};
  }
  result.warnings.insert(result.warnings.begin(), declaration_.warnings.begin(), declaration_.warnings.end());
  if (plane)
    result.warnings.push_back(
        "point-to-plane residuals are biased by the noise along depth; the depth residual is not");
  Judge(box, start, fit, &result);
  return result;
}

Result<std::unique_ptr<Scanner>> LoadTurntable(const Dataset& dataset) {
  Turntable model(Turntable::Residuals::kDepth);
  SCANCAL_ASSIGN_OR_RETURN(TurntableDeclaration declaration, DeclareTurntable(dataset, &model));
  std::vector<Placement> placements;
  for (const ScanDeclaration& scan : declaration.scans) {
    SCANCAL_ASSIGN_OR_RETURN(Placement placement, ReadPlacement(scan, declaration.sense));
    placements.push_back(std::move(placement));
  }
  SCANCAL_RETURN_IF_ERROR(CheckPlausible(placements));
  return std::unique_ptr<Scanner>(
      std::make_unique<TurntableScanner>(std::move(declaration), std::move(model), std::move(placements)));
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
