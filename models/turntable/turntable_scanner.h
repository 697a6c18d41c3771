// The turntable as a Scanner: search, start, verdicts by name.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>
#include "models/scanner.h"
#include "models/turntable.h"
#include "models/turntable/declaration.h"
#include "models/turntable/placement.h"
#include "models/turntable/plane_storey.h"

namespace scancal {

// One a placement.
std::vector<PlaneStorey> StoreysOf(const std::vector<Placement>& placements, const turntable::System& system);

// Where refinement starts: the minimum of the grid search, or what a depth fit finds from there or, if that is better,
// from the middle of the search interval.
struct TurntableStart {
  std::vector<PlaneStorey> storeys;  // one a placement, of the system as the data set declares it
  GridResult grid;
  turntable::System system;
};

// A joint fit of M, N, the planes, and what else is estimated.
struct TurntableFit {
  std::vector<Turntable::Target> targets;  // as they entered: the planes from which normal_1, normal_2, distance count
  Solution solution;
  double sigma = 1;  // by which the rows were divided, mm
  std::array<double, 2> depths{};
  turntable::System Found() const;
  std::pair<Eigen::Vector3d, double> Plane(size_t target) const;
};

class TurntableScanner final : public Scanner {
 public:
  // model: carries the roles of the quantities.
  TurntableScanner(TurntableDeclaration declaration, Turntable model, std::vector<Placement> placements);
  std::string Describe() const override;
  const Dataset& dataset() const override { return declaration_.dataset; }
  std::vector<std::filesystem::path> Files() const override;
  Result<Json> Data() const override;
  Result<Calibration> Calibrate(const RefineChoice& choice) const override;
  Result<Comparison> Compare(const CompareChoice& choice) const override;
  Result<void> WriteSurface(const std::filesystem::path& file) const override;

  // Computed once. M or N that are not estimated keep their value.
  const Result<TurntableStart>& Start() const;
  // The same from a search over another box.
  Result<TurntableStart> StartIn(const GridBox& box) const;
  // From planes fitted in closed form to the points as `system` sees them; estimate: indices of further quantities to
  // be estimated (Turntable::kTiltX); without: leave that placement out.
  TurntableFit Fit(const turntable::System& system, Turntable::Residuals residuals,
                   const std::vector<int>& estimate = {}, std::optional<size_t> without = {},
                   int max_iterations = 100) const;
  // The headline: from a depth fit with equal weights to its variances and generalised least squares.
  TurntableFit FitWeighted(const TurntableFit& plain, int max_iterations = 100) const;
  const std::vector<Placement>& placements() const { return placements_; }
  turntable::System Declared() const;  // what the search uses for all but M and N
  // The box of the search with the declared step.
  GridBox Box() const;

 private:
  GridResult SearchKnowing(const turntable::System& found, const TurntableStart& start) const;

  TurntableDeclaration declaration_;
  Turntable model_;
  std::vector<Placement> placements_;
  mutable std::optional<Result<TurntableStart>> start_;
};

// From clean points in memory: sets aside what is off each plane, and compresses the rest.
Result<std::unique_ptr<TurntableScanner>> CompressTurntable(const TurntableDeclaration& declaration,
                                                            const Turntable& model, const std::vector<RawScan>& scans);
Result<std::unique_ptr<Scanner>> LoadTurntable(const Dataset& dataset);
Result<std::unique_ptr<Scanner>> ReloadTurntable(const Dataset& dataset, const Json& data, const std::string& file);
Result<int64_t> TransformTurntable(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud);
Result<Propagation> PropagateTurntable(const Calibration& calibration, const PointRequest& points, bool distances);

inline constexpr ScannerKind kTurntable = {"turntable", &LoadTurntable, &ReloadTurntable, &TransformTurntable,
                                           &PropagateTurntable};

}  // namespace scancal
