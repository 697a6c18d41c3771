// The robot with a scanner as a Scanner.
#pragma once
#include <memory>
#include "models/robot_ball/declaration.h"
#include "models/scanner.h"

namespace scancal {

class RobotScanner final : public Scanner {
 public:
  RobotScanner(RobotDeclaration declaration, RobotBall model)
      : declaration_(std::move(declaration)), model_(std::move(model)) {}
  std::string Describe() const override;
  const Dataset& dataset() const override { return declaration_.dataset; }
  std::vector<std::filesystem::path> Files() const override { return declaration_.files; }
  Result<Json> Data() const override;
  Result<Calibration> Calibrate(const RefineChoice& choice) const override;
  // Nominal robot, the published methods, the refinement: errors of the check lengths, largest and mean first.
  Result<Comparison> Compare(const CompareChoice& choice) const override;
  Result<void> WriteSurface(const std::filesystem::path& file) const override;  // an Error: there is no search

 private:
  RobotDeclaration declaration_;
  RobotBall model_;
};

Result<std::unique_ptr<Scanner>> LoadRobot(const Dataset& dataset);
Result<std::unique_ptr<Scanner>> ReloadRobot(const Dataset& dataset, const Json& data, const std::string& file);
// Every ball centre in the base; scan: the number of its station.
Result<int64_t> TransformRobot(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud);
Result<Propagation> PropagateRobot(const Calibration& calibration, const PointRequest& points, bool distances);

inline constexpr ScannerKind kRobotBall = {"robot-ball", &LoadRobot, &ReloadRobot, &TransformRobot, &PropagateRobot};

}  // namespace scancal
