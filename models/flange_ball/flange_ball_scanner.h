// The robot with a ball on its flange as a Scanner.
#pragma once
#include <memory>
#include <string>
#include <vector>
#include "models/flange_ball/declaration.h"
#include "models/flange_ball/flange_ball_fit.h"
#include "models/scanner.h"

namespace scancal {

class FlangeBallScanner final : public Scanner {
 public:
  // targets, check: in the order of the declaration.
  FlangeBallScanner(FlangeBallDeclaration declaration, std::vector<FlangeBall::Target> targets,
                    std::vector<FlangeBall::Target> check);
  std::string Describe() const override;
  const Dataset& dataset() const override { return declaration_.dataset; }
  std::vector<std::filesystem::path> Files() const override;
  Result<Json> Data() const override;
  Result<Calibration> Calibrate(const RefineChoice& choice) const override;
  // The nominal robot, of which only the ball is fitted, and the refined one: how far the ball strays in its sockets,
  // where the tool was calibrated with and where it was held out.
  Result<Comparison> Compare(const CompareChoice& choice) const override;
  Result<void> WriteSurface(const std::filesystem::path& file) const override;  // an Error: there is no search

 private:
  double Spacing() const;  // as declared, mm
  Result<Solution> Fit(const RefineChoice& choice) const;

  FlangeBallDeclaration declaration_;
  std::vector<FlangeBall::Target> targets_, check_;
};

// An Error names the quantities that these locations do not determine.
Result<void> CheckDetermined(const Solution& solution);

// Warns of a ball so near to the last joint's axis that the link before is known to a few mm only.
void JudgeBall(const RobotWithBall& robot, Calibration* calibration);

// Warns of a ball that strays much farther where the tool was held out (mean spreads, mm).
void JudgeHeldOut(double spread, double held_out, Calibration* calibration);

Result<std::unique_ptr<Scanner>> LoadFlangeBall(const Dataset& dataset);
Result<std::unique_ptr<Scanner>> ReloadFlangeBall(const Dataset& dataset, const Json& data, const std::string& file);
// The ball of every pose in the base, held out ones as well; a scan is a location of the tool.
Result<int64_t> TransformFlangeBall(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud);
Result<Propagation> PropagateFlangeBall(const Calibration& calibration, const PointRequest& points, bool distances);

inline constexpr ScannerKind kFlangeBall = {"flange-ball", &LoadFlangeBall, &ReloadFlangeBall, &TransformFlangeBall,
                                            &PropagateFlangeBall};

}  // namespace scancal
