// The turntable as a Scanner: start, joint fit, verdicts, comparison.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>
#include "models/scanner.h"
#include "models/turntable/declare.h"
#include "models/turntable/search.h"
#include "models/turntable/use.h"
#include "models/turntable/verify.h"

namespace scancal::turntable {

// Where refinement starts: the minimum of the grid search, or what a depth fit finds from there or, if that is better,
// from the middle of the search interval.
struct Start {
  std::vector<PlaneStorey> storeys;  // one a placement, of the system as the data set declares it
  GridResult grid;
  System system;
};

// A joint fit of M, N, the planes, and what else is estimated.
struct JointFit {
  std::vector<Model::Target> targets;  // as they entered: the planes from which normal_1, normal_2, distance count
  Solution solution;
  double sigma = 1;  // by which the rows were divided, mm
  std::array<double, 2> depths{}, heights{};
  bool plate_cut_off = false;  // one_plate was declared, but the placements do not show the same rectangle of it
  System Found() const;
  std::pair<Eigen::Vector3d, double> Plane(size_t target) const;
};

struct FitChoice {
  std::vector<int> estimate = {};      // indices of further quantities to be estimated (Model::kTiltX)
  std::optional<size_t> without = {};  // leaves that placement out
  int max_iterations = 100;
  bool influences = true;  // false: only the values count, so columns are left out of what none of them depends on
};

class Scanner final : public scancal::Scanner {
 public:
  // model: carries the roles of the quantities. For one thread.
  Scanner(Declaration declaration, Model model, std::vector<Placement> placements);
  std::string Describe() const override;
  const Dataset& dataset() const override { return declaration_.dataset; }
  std::vector<std::filesystem::path> Files() const override;
  Result<Json> Data() const override;
  Result<Calibration> Calibrate(const RefineChoice& choice) const override;
  Result<Comparison> Compare(const CompareChoice& choice) const override;
  Result<void> WriteSurface(const std::filesystem::path& file) const override;

  // Computed once. M or N that are not estimated keep their value.
  const Result<Start>& FindStart() const;
  // The same from a search over another box.
  Result<Start> FindStartIn(const GridBox& box) const;
  // From planes fitted in closed form to the points as `system` sees them.
  JointFit Fit(const System& system, Model::Residuals residuals, const FitChoice& choice = {}) const;
  // The headline: from a depth fit with equal weights to its variances and generalised least squares.
  JointFit FitWeighted(const JointFit& plain, int max_iterations = 100) const;
  const std::vector<Placement>& placements() const { return placements_; }
  System Declared() const;  // what the search uses for all but M and N
  // The box of the search with the declared step.
  GridBox Box() const;

 private:
  GridResult SearchKnowing(const System& found, const Start& start) const;

  Declaration declaration_;
  Model model_;
  std::vector<Placement> placements_;
  mutable std::optional<Result<Start>> start_;
};

// What may go wrong with planes on a turntable, told by name. Units and angles that cannot be: "angles span 30 rad ...;
// are they degrees?"
Result<void> CheckPlausible(const std::vector<Placement>& placements, const Units& units);

// Before the fit: plates that determine nothing because all are perpendicular to the axis.
Result<void> CheckOrientations(const Quantities& quantities, const std::vector<Placement>& placements,
                               const std::vector<PlaneStorey>& storeys, const System& system);

// At the start of the refinement: plates that are seen edge-on.
Result<void> CheckIncidence(const std::vector<Placement>& placements, const System& system);

// After the fit: quantities without effect of their own.
Result<void> CheckDetermined(const JointFit& fit);

// Doubts about a computed result: minimum on the edge, parallel placements, a narrow sweep. grid: of a search that
// knows what was found besides M and N.
void Judge(const GridBox& box, const std::vector<Placement>& placements, const GridResult& grid, const JointFit& fit,
           Calibration* calibration);

// What a drift of the depth would move M and N by, where sweeps go one way and nobody has declared one: nothing if they
// tell it, or it is declared.
std::optional<Sentence> NoteOnDrift(const JointFit& fit);
// What plates that are not flat would move M and N by, where nothing of it was declared.
std::optional<Sentence> NoteOnForm(const JointFit& fit);

// Whether each placement is one plane: from profile to profile (in the frame of the table as `system` says), and within
// its profiles. The first of what is unreliable.
void JudgePlanes(const std::vector<Placement>& placements, const System& system, Calibration* calibration);
void JudgeProfiles(const std::vector<Placement>& placements, Calibration* calibration);

// Whether all profiles are bent alike, as by the lens, by so much that M or N would be wrong by more than u.
void JudgeCurvature(const std::vector<Placement>& placements, const JointFit& fit, Calibration* calibration);

// Where sweeps told a drift: whether it goes on from scan to scan, or begins anew, they did not. Considers `drift` with
// u = n |drift_sweep| / sqrt(3) for n targets, and says so; nothing where it is declared, or no drift was found.
std::optional<Sentence> ConsiderDriftBetweenScans(bool declared, JointFit* fit);

// Where the search holds (-M, -N), too, and nobody has said which way depth grows.
void JudgeMirrorImage(bool depth_declared, const GridBox& box, const std::vector<Placement>& placements,
                      Calibration* calibration);

// From clean points in memory: sets aside what is off each plane, and compresses the rest.
Result<std::unique_ptr<Scanner>> Compress(const Declaration& declaration, const Model& model,
                                          const std::vector<RawScan>& scans);
Result<std::unique_ptr<scancal::Scanner>> Load(const Dataset& dataset);
Result<std::unique_ptr<scancal::Scanner>> Reload(const Dataset& dataset, const Json& data, const std::string& file);

inline constexpr ScannerKind kKind = {"turntable", &Load, &Reload, &Transform, &Propagate, true, &Verify};

}  // namespace scancal::turntable
