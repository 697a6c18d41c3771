#include "models/turntable/scanner.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include "io/json_file.h"
#include "io/output_file.h"
#include "io/progress.h"
#include "models/turntable/planes_file.h"
#include "models/turntable/tables.h"
#include "solver/parallel.h"

namespace scancal::turntable {
namespace {

constexpr Message<> kPlaneIsBiased{
    "turntable.plane_is_biased",
    "point-to-plane residuals are biased by the noise along depth; the depth residual is not",
    "Residuen als Abstand Punkt–Ebene werden durch das Rauschen längs der Tiefe systematisch verfälscht, "
    "Tiefenresiduen nicht"};
constexpr Message<> kPlateCutOff{
    "turntable.plate_cut_off",
    "one_plate: the placements do not show the same rectangle of the plate, so its edges are not in view, and its form "
    "is "
    "not the same function in each; for each parameter the worse of one form and of several was taken",
    "one_plate: Die Aufstellungen zeigen nicht dasselbe Rechteck der Platte; ihre Kanten sind also nicht im Bild, und "
    "ihre "
    "Form ist nicht in jeder dieselbe Funktion. Für jeden Parameter wurde das Ungünstigere aus einer Form und mehreren "
    "genommen"};

// How the files were read, where one is not plain: what all have in common once.
std::string Dialects(const std::vector<Placement>& placements) {
  const auto like_first = [&](const Placement& each) { return each.dialect == placements.front().dialect; };
  const bool same = std::all_of(placements.begin(), placements.end(), like_first);
  std::string text;
  for (const Placement& each : placements)
    if (!each.dialect.empty() && (!same || text.empty()))
      text += fmt::format(" {}: {}.", same ? "Text" : each.name, each.dialect);
  return text;
}

const char kSearching[] = "searching M, N";
constexpr int kRoundsOfReading = 4;
constexpr double kNodesOfReading = 60;  // a side

System DeclaredOf(const Model& model) {
  System system;
  for (size_t k = 0; k < system.q.size(); ++k) system[k] = model.quantities()[k].value;
  return system;
}

bool SamePoints(const std::vector<PointsOnPlane>& a, const std::vector<PointsOnPlane>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return x.off == y.off; });
}

GridBox BoxOf(const Declaration& declaration, const Model& model) {
  GridBox box = declaration.search;
  for (size_t k = 0; k < 2; ++k) {
    const Quantity& quantity = model.quantities()[k == 0 ? Model::kM : Model::kN];
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
  for (const RawScan& scan : scans) {
    depths = {std::min(depths[0], scan.seen.depths[0]), std::max(depths[1], scan.seen.depths[1])};
    for (const RawProfile& profile : scan.profiles)
      for (const double y : profile.y) depths = {std::min(depths[0], y), std::max(depths[1], y)};
  }
  return depths;
}

// All of them, clean, some at a time.
Result<std::vector<RawScan>> ReadScans(const Declaration& declaration) {
  const size_t count = declaration.scans.size();
  std::vector<std::optional<Result<RawScan>>> read(count);
  Progress progress("reading");
  std::mutex one_at_a_time;
  std::vector<double> done(count);
  InParallel(count, 0, [&](size_t k) {
    read[k] = ReadScan(declaration.scans[k], declaration.senses, [&](double fraction) {
      const std::lock_guard lock(one_at_a_time);
      done[k] = fraction / static_cast<double>(count);
      progress.Show(std::accumulate(done.begin(), done.end(), 0.0));
    });
  });
  std::vector<RawScan> scans;
  for (auto& each : read) {
    SCANCAL_ASSIGN_OR_RETURN(scans.emplace_back(), std::move(*each));
  }
  Unwind(&scans);
  DropCopies(&scans);
  return scans;
}

}  // namespace

Scanner::Scanner(Declaration declaration, Model model, std::vector<Placement> placements)
    : declaration_(std::move(declaration)), model_(std::move(model)), placements_(std::move(placements)) {}

GridBox Scanner::Box() const { return BoxOf(declaration_, model_); }

System Scanner::Declared() const {
  System system = DeclaredOf(model_);
  const ScannedVolume volume = VolumeOf(placements_);
  system.depths = volume.y;
  system.heights = volume.z;
  return system;
}

const Result<Start>& Scanner::FindStart() const {
  if (!start_) start_ = FindStartIn(Box());
  return *start_;
}

Result<Start> Scanner::FindStartIn(const GridBox& box) const {
  Start start;
  const System declared = Declared(), middle = MiddleOf(Box(), declared);
  start.storeys = StoreysOf(placements_, declared);
  SCANCAL_RETURN_IF_ERROR(CheckOrientations(model_.quantities(), placements_, start.storeys, middle));
  start.grid = Search(box, start.storeys, PlaneFit::kOrthogonal, kSearching);
  start.system = declared.With(start.grid.best.at[0], start.grid.best.at[1]);
  // The noise of a lidar can pull the minimum of S far away. The middle of the interval is free of that, and two starts
  // that end in one place are no local minimum.
  double least = std::numeric_limits<double>::infinity();
  for (const System& from : {System(start.system), middle}) {
    const JointFit fit = Fit(from, Model::Residuals::kDepth, {.influences = false});
    if (!(fit.solution.fit.cost < least) || !CheckDetermined(fit).ok()) continue;
    least = fit.solution.fit.cost;
    start.system = fit.Found();
  }
  SCANCAL_RETURN_IF_ERROR(CheckIncidence(placements_, start.system));
  return start;
}

// The search as it would be, had the data set declared what was found besides M and N: only its minimum is comparable.
GridResult Scanner::SearchKnowing(const System& found, const Start& start) const {
  const bool as_declared = Declared().With(found.M(), found.N()).q == found.q;
  return as_declared ? start.grid : Search(Box(), StoreysOf(placements_, found), PlaneFit::kOrthogonal, kSearching);
}

Result<Calibration> Scanner::Calibrate(const RefineChoice& choice) const {
  const bool plane = choice.residual == "plane";
  if (!plane && !choice.residual.empty() && choice.residual != "depth")
    return Error{"residual: found \"" + choice.residual + "\", expected depth or plane"};
  const bool weighted = !plane && !choice.equal_weights;
  SCANCAL_RETURN_IF_ERROR(CheckMonteCarlo(choice, weighted));
  SCANCAL_ASSIGN_OR_RETURN(const Start start, FindStart());
  const Stopwatch watch;
  JointFit fit = Fit(start.system, plane ? Model::Residuals::kPlane : Model::Residuals::kDepth,
                     {.max_iterations = choice.max_iterations});
  SCANCAL_RETURN_IF_ERROR(CheckDetermined(fit));
  if (weighted) fit = FitWeighted(fit, choice.max_iterations);
  const std::optional<Sentence> between = ConsiderDriftBetweenScans(declaration_.drift_declared, &fit);
  const double seconds = watch.Seconds();

  // Within a profile the plain residual repeats as the depth does, seen at an angle: its pure error is not comparable.
  Calibration result = Conclude(declaration_.dataset,
                                {fit.solution, plane ? "plane" : "depth", seconds,
                                 plane ? PureError{} : PureOf(placements_), declaration_.warnings},
                                choice.monte_carlo);
  result.lack_of_fit.pure_error_sigma = PureOf(placements_).sigma();
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
    if (choice.figures) target.residual_tables = ResidualTables({placements_[t], fit.targets[t], values, found});
    target.missing = placements_[t].missing;
    target.set_aside = placements_[t].set_aside;
    target.residuals = ResidualsOf(placements_[t]);
    const auto [normal, distance] = fit.Plane(t);
    target.geometry = {{"normal", {normal[0], normal[1], normal[2]}}, {"distance", {distance}}};
  }
  if (plane) result.warnings.push_back(Say(kPlaneIsBiased));
  Judge(box, placements_, SearchKnowing(found, start), fit, &result);
  result.notes.insert(result.notes.begin(), declaration_.notes.begin(), declaration_.notes.end());
  if (between) result.notes.push_back(*between);
  if (fit.plate_cut_off) result.notes.push_back(Say(kPlateCutOff));
  if (const std::optional<Sentence> drift = NoteOnDrift(fit)) result.notes.push_back(*drift);
  if (const std::optional<Sentence> form = plane ? std::nullopt : NoteOnForm(fit)) result.notes.push_back(*form);
  JudgeCurvature(placements_, fit, &result);
  JudgeMirrorImage(declaration_.senses.depth_declared, box, placements_, &result);
  AddVolume(placements_, &result);
  if (choice.figures) AddSurface(box, start.storeys, StoreysOf(placements_, found), &result);
  AddScene(placements_, &result);
  return result;
}

Result<std::unique_ptr<scancal::Scanner>> Load(const Dataset& dataset) {
  Model model(Model::Residuals::kDepth);
  SCANCAL_ASSIGN_OR_RETURN(Declaration declaration, Declare(dataset, &model));
  SCANCAL_RETURN_IF_ERROR(ChoosePlanes(&declaration));
  SCANCAL_ASSIGN_OR_RETURN(const std::vector<RawScan> scans, ReadScans(declaration));
  for (const RawScan& scan : scans)
    declaration.warnings.insert(declaration.warnings.end(), scan.warnings.begin(), scan.warnings.end());
  SCANCAL_ASSIGN_OR_RETURN(std::unique_ptr<Scanner> scanner, Compress(declaration, model, scans));
  return std::unique_ptr<scancal::Scanner>(std::move(scanner));
}

// Setting aside needs M and N, finding them needs clean points: in turn, until nothing changes. The first round is in
// the middle of the search interval; a coarse search begins the same refinement as the declared one.
Result<std::unique_ptr<Scanner>> Compress(const Declaration& declaration, const Model& model,
                                          const std::vector<RawScan>& scans) {
  const GridBox box = BoxOf(declaration, model);
  System system = MiddleOf(box, DeclaredOf(model));
  system.depths = DepthsOf(scans);
  for (const RawScan& scan : scans) {
    for (const Profile& profile : scan.compressed) {
      const auto [low, high] = Ends(profile.factor);
      system.heights = system.heights == std::array<double, 2>{}
                           ? std::array{low.z, high.z}
                           : std::array{std::min(system.heights[0], low.z), std::max(system.heights[1], high.z)};
    }
  }
  std::vector<PointsOnPlane> points;
  std::vector<Placement> placements;
  for (int round = 0; round < kRoundsOfReading; ++round) {
    std::vector<PointsOnPlane> left(scans.size());
    InParallel(scans.size(), 0, [&](size_t k) { left[k] = SetAsideOffPlane(scans[k], system); });
    if (round > 0 && SamePoints(left, points)) break;
    points = std::move(left);
    placements.clear();
    for (size_t k = 0; k < scans.size(); ++k) placements.push_back(MakePlacement(scans[k], points[k]));
    SCANCAL_RETURN_IF_ERROR(CheckPlausible(placements, declaration.dataset.units));
    const Result<Start> start = Scanner(declaration, model, placements).FindStartIn(Coarse(box));
    if (!start.ok()) break;  // Calibrate will say so
    system = start->system;
  }
  for (size_t k = 0; k < scans.size(); ++k) LookAtResiduals(scans[k], points[k], &placements[k]);
  return std::make_unique<Scanner>(declaration, model, std::move(placements));
}

std::vector<std::filesystem::path> Scanner::Files() const {
  std::vector<std::filesystem::path> files = {declaration_.dataset.file};
  const auto add = [&](const std::filesystem::path& file) {
    if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
  };
  for (const ScanDeclaration& scan : declaration_.scans) {
    if (scan.plane) add(declaration_.dataset.file.parent_path() / scan.planes);
    add(scan.format.path);
    if (scan.format.angle && !scan.format.angle->file.empty()) add(scan.format.angle->file);
  }
  return files;
}

std::string Scanner::Describe() const {
  const GridBox& box = declaration_.search;
  double profiles = 0, points = 0, missing = 0, off = 0;
  for (const Placement& placement : placements_) {
    profiles += static_cast<double>(placement.profiles.size());
    points += placement.Points();
    missing += placement.missing;
    for (const auto& [reason, count] : placement.set_aside) off += count;
  }
  return fmt::format(
      "{}, table seen to turn {} from +Z; {} targets, {} profiles, {} points used, {} missing, {} set aside{}.{}",
      Opening(declaration_.dataset, "turntable"), declaration_.senses.angle > 0 ? "clockwise" : "counterclockwise",
      placements_.size(), profiles, points, missing, off,
      declaration_.searches ? fmt::format("; M searched from {:g} to {:g} mm, N from {:g} to {:g} mm", box.lower[0],
                                          box.upper[0], box.lower[1], box.upper[1])
                            : "",
      Dialects(placements_));
}

Result<void> Scanner::WriteSurface(const std::filesystem::path& file) const {
  SCANCAL_ASSIGN_OR_RETURN(const Start start, FindStart());
  SCANCAL_ASSIGN_OR_RETURN(OutputFile output, OutputFile::Create(file));
  SCANCAL_RETURN_IF_ERROR(output.Write("M_mm,N_mm,S_published_mm,S_orthogonal_mm\n"));
  const GridBox box = Box();
  const auto [rows, columns] = box.Nodes();
  for (int64_t i = 0; i < rows; ++i) {
    for (int64_t j = 0; j < columns; ++j) {
      const auto [M, N] = box.At(i, j);
      SCANCAL_RETURN_IF_ERROR(output.Write(fmt::format("{:.10g},{:.10g},{:.10g},{:.10g}\n", M, N,
                                                       SAt(start.storeys, M, N, PlaneFit::kVertical),
                                                       SAt(start.storeys, M, N, PlaneFit::kOrthogonal))));
    }
  }
  return output.Commit();
}

Result<Json> Scanner::Data() const {
  Json data = {{"dataset", declaration_.dataset.text}};
  SCANCAL_ASSIGN_OR_RETURN(const Json placements, PlacementsToJson(placements_));
  data.update(placements);
  return data;
}

Result<std::unique_ptr<scancal::Scanner>> Reload(const Dataset& dataset, const Json& data, const std::string& file) {
  Model model(Model::Residuals::kDepth);
  SCANCAL_ASSIGN_OR_RETURN(Declaration declaration, Declare(dataset, &model));
  SCANCAL_ASSIGN_OR_RETURN(std::vector<Placement> placements, PlacementsFromJson(data, file));
  auto scan = declaration.scans.begin();  // a copy of another target is not among the placements
  for (const Placement& placement : placements) {
    const auto is_its_own = [&](const ScanDeclaration& each) {
      return each.planes.empty() ? each.name == placement.name : placement.name.starts_with(each.name + " ");
    };
    scan = std::find_if(scan, declaration.scans.end(), is_its_own);
    if (scan == declaration.scans.end()) break;
  }
  const bool as_declared = scan != declaration.scans.end() && !placements.empty();
  if (!as_declared) return Error{file + ": data: expected the targets that data: dataset declares, in their order"};
  for (const Placement& placement : placements)
    declaration.warnings.insert(declaration.warnings.end(), placement.warnings.begin(), placement.warnings.end());
  declaration.scans.clear();  // nothing is left to be read, Files() is dataset.yaml alone
  SCANCAL_RETURN_IF_ERROR(CheckPlausible(placements, dataset.units));
  return std::unique_ptr<scancal::Scanner>(
      std::make_unique<Scanner>(std::move(declaration), std::move(model), std::move(placements)));
}

}  // namespace scancal::turntable
