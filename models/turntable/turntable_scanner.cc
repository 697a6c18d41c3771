#include "models/turntable/turntable_scanner.h"
#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include "io/progress.h"
#include "models/parts/correlated_noise.h"
#include "models/parts/median.h"
#include "models/turntable/smooth_columns.h"
#include "models/turntable/verdicts.h"
#include "models/turntable/volume.h"

namespace scancal {
namespace {

constexpr int kRoundsOfReading = 4;

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

TurntablePose MiddleOf(const GridBox& box, const Turntable& model) {
  TurntablePose pose = PoseOf(model.quantities());
  pose.M = (box.lower[0] + box.upper[0]) / 2;
  pose.N = (box.lower[1] + box.upper[1]) / 2;
  return pose;
}

PureError Pooled(const std::vector<Placement>& placements) {
  PureError sum;
  for (const Placement& placement : placements) {
    sum.sum_of_squares += placement.Pure().sum_of_squares;
    sum.dof += placement.Pure().dof;
  }
  return sum;
}

// Line correlation declared as a length: what it adds to the offset and the slope of a profile of the usual size.
void DeclareLineCorrelation(const TurntableDeclaration& declaration, const std::vector<Placement>& placements,
                            Turntable* model) {
  if (!declaration.line_correlation) return;
  const Quantity& noise = model->quantities()[Turntable::kNoiseY];
  const double sigma = noise.role == Role::kConsider ? noise.u : std::max(Pooled(placements).sigma(), kLeastSigma_mm);
  std::vector<double> counts, spreads;
  for (const Placement& placement : placements) {
    for (const Profile& profile : placement.profiles) {
      counts.push_back(profile.count);
      spreads.push_back(profile.factor(1, 1) / profile.factor(0, 0));
    }
  }
  const LineNoise excess = ExcessOfCorrelatedNoise(*declaration.line_correlation, Median(counts), Median(spreads));
  for (const auto& [k, u] : {std::pair{Turntable::kLineOffset, excess.offset}, {Turntable::kLineSlope, excess.slope}}) {
    model->quantity(k).role = Role::kConsider;
    model->quantity(k).u = sigma * u;
  }
}

}  // namespace

TurntableScanner::TurntableScanner(TurntableDeclaration declaration, Turntable model, std::vector<Placement> placements)
    : declaration_(std::move(declaration)), model_(std::move(model)), placements_(std::move(placements)) {}

GridBox TurntableScanner::Box() const { return BoxOf(declaration_, model_); }

TurntablePose TurntableScanner::Nominal() const { return PoseOf(model_.quantities()); }

GridResult TurntableScanner::Search(const std::vector<PlaneStorey>& storeys) const {
  Progress progress("searching M, N");
  const auto rmse = [&](const std::array<double, 2>& at, std::span<double> values) {
    for (size_t t = 0; t < values.size(); ++t) values[t] = storeys[t].Rmse(at[0], at[1], PlaneFit::kOrthogonal);
  };
  return GridSearch(Box(), static_cast<int>(storeys.size()), rmse, 2, [&](double done) { progress.Show(done); });
}

Result<TurntableStart> TurntableScanner::Initialize() const {
  TurntableStart start;
  const TurntablePose nominal = Nominal(), middle = MiddleOf(Box(), model_);
  start.storeys = Storeys(placements_, nominal);
  SCANCAL_RETURN_IF_ERROR(CheckOrientations(model_.quantities(), placements_, start.storeys, middle));
  start.grid = Search(start.storeys);
  start.pose = nominal;
  start.pose.M = start.grid.best.at[0];
  start.pose.N = start.grid.best.at[1];
  // The noise of a lidar can pull the minimum of S far away. The middle of the interval is free of that, and two starts
  // that end in one place are no local minimum.
  double least = std::numeric_limits<double>::infinity();
  for (const TurntablePose& from : {TurntablePose(start.pose), middle}) {
    const TurntableFit fit = Fit(from, Turntable::Residuals::kDepth);
    if (!(fit.solution.fit.cost < least) || !CheckDetermined(fit).ok()) continue;
    least = fit.solution.fit.cost;
    start.pose = fit.Pose();
  }
  SCANCAL_RETURN_IF_ERROR(CheckIncidence(placements_, start.storeys, start.pose));
  return start;
}

TurntableFit TurntableScanner::Fit(const TurntablePose& pose, Turntable::Residuals residuals,
                                   const std::vector<int>& estimate, std::optional<size_t> without,
                                   int max_iterations) const {
  TurntableFit fit;
  std::vector<Placement> placements = placements_;
  if (without) placements.erase(placements.begin() + static_cast<std::ptrdiff_t>(*without));
  const std::vector<PlaneStorey> storeys = Storeys(placements, pose);
  double rms = kLeastSigma_mm;
  for (const PlaneStorey& storey : storeys) rms = std::max(rms, storey.Rmse(pose.M, pose.N, PlaneFit::kOrthogonal));
  const double pure = Pooled(placements).sigma();
  fit.sigma = residuals == Turntable::Residuals::kDepth && pure > kLeastSigma_mm ? pure : rms;
  const auto model = std::make_shared<Turntable>(residuals);
  for (int k = 0; k < std::ssize(model_.quantities()); ++k) model->quantity(k) = model_.quantities()[k];
  for (const int k : estimate) model->quantity(k).role = Role::kEstimate;
  DeclareLineCorrelation(declaration_, placements, model.get());
  for (size_t t = 0; t < placements.size(); ++t) {
    Turntable::Target& target = fit.targets.emplace_back();
    target.name = placements[t].name;
    target.views = Views(placements[t].profiles, residuals);
    const auto [normal, distance] = storeys[t].FitPlane(pose.M, pose.N);
    Turntable::SetPlane(normal, distance, &target);
    if (residuals == Turntable::Residuals::kDepth)
      AddForm(placements[t].profiles, pose, normal, distance, &target.views);
  }
  if (residuals == Turntable::Residuals::kDepth) AddBend(placements, &fit.targets);
  Problem problem = MakeProblem<Turntable>(model, fit.targets);
  problem.WeighEqually(fit.sigma);
  Estimate from = NominalStart(problem);
  Eigen::Index e = 0;
  for (const int k : problem.With({Scope::kSystem}, Role::kEstimate)) {
    if (k == Turntable::kM) from.system[e] = pose.M;
    if (k == Turntable::kN) from.system[e] = pose.N;
    ++e;
  }
  fit.solution = Solve(std::move(problem), from, {max_iterations});
  return fit;
}

TurntableFit TurntableScanner::FitWeighted(const TurntableFit& plain, int max_iterations) const {
  TurntableFit fit = plain;
  fit.solution = SolveWeighted(plain.solution, kLeastSigma_mm, {max_iterations});
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
  const bool weighted = !plane && !choice.equal_weights;
  if (!weighted && choice.monte_carlo.trials > 0)
    return Error{"montecarlo: found equal weights, expected estimated ones: only they say how large all noise is"};
  SCANCAL_ASSIGN_OR_RETURN(const TurntableStart start, Initialize());
  const auto began = std::chrono::steady_clock::now();
  TurntableFit fit = Fit(start.pose, plane ? Turntable::Residuals::kPlane : Turntable::Residuals::kDepth, {}, {},
                         choice.max_iterations);
  SCANCAL_RETURN_IF_ERROR(CheckDetermined(fit));
  if (weighted) fit = FitWeighted(fit, choice.max_iterations);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;

  // Within a profile the plain residual repeats as the depth does, seen at an angle: its pure error is not comparable.
  Calibration result = Summarize(fit.solution, plane ? PureError{} : Pooled(placements_));
  result.lack_of_fit.pure_error_sigma = Pooled(placements_).sigma();
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
  for (size_t t = 0; t < result.targets.size(); ++t) {
    TargetSummary& target = result.targets[t];
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
  JudgeTurntable(box, placements_, start, fit, &result);
  AddVolume(placements_, &result);
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
// the middle of the search interval.
Result<std::unique_ptr<TurntableScanner>> CompressTurntable(const TurntableDeclaration& declaration,
                                                            const Turntable& model, const std::vector<RawScan>& scans) {
  std::unique_ptr<TurntableScanner> scanner;
  TurntablePose pose = MiddleOf(BoxOf(declaration, model), model);
  for (int round = 0; round < kRoundsOfReading; ++round) {
    std::vector<Placement> placements;
    for (const RawScan& scan : scans) placements.push_back(CompressPlacement(scan, pose));
    if (scanner && SamePoints(placements, scanner->placements())) break;
    SCANCAL_RETURN_IF_ERROR(CheckPlausible(placements, declaration.dataset.units));
    scanner = std::make_unique<TurntableScanner>(declaration, model, std::move(placements));
    const Result<TurntableStart> start = scanner->Initialize();
    if (!start.ok()) break;  // Calibrate will say so
    pose = start->pose;
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
