// The robot with a scanner as a Scanner.
#pragma once
#include <memory>
#include <string>
#include "models/robot_ball/declare.h"
#include "models/scanner.h"

namespace scancal::robot_ball {

class Scanner final : public scancal::Scanner {
 public:
  Scanner(Declaration declaration, Model model) : declaration_(std::move(declaration)), model_(std::move(model)) {}
  std::string Describe() const override;
  const Dataset& dataset() const override { return declaration_.dataset; }
  std::vector<std::filesystem::path> Files() const override { return declaration_.files; }
  Result<Json> Data() const override;
  Result<Calibration> Calibrate(const RefineChoice& choice) const override;
  // Nominal robot, the published methods, the refinement: errors of the check lengths, largest and mean first.
  Result<Comparison> Compare(const CompareChoice& choice) const override;

 private:
  Declaration declaration_;
  Model model_;
};

// What a robot saw, as calibration.json keeps it: data, u_of_spheres, centres_have_u and warnings; every number as it
// was. file: for messages.
Json ToJson(const Declaration& declaration);
Result<Declaration> FromJson(const Json& data, const std::string& file);

Result<std::unique_ptr<scancal::Scanner>> Load(const Dataset& dataset);
Result<std::unique_ptr<scancal::Scanner>> Reload(const Dataset& dataset, const Json& data, const std::string& file);
// Every ball centre in the base; scan: the number of its station.
Result<int64_t> Transform(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud);

// Points of the scanner, or of the tool, at joint angles: columns q1 .. qn, x, y, z.
Result<Propagation> Propagate(const Calibration& calibration, const PointRequest& points, bool distances);

inline constexpr ScannerKind kKind = {"robot-ball", &Load, &Reload, &Transform, &Propagate};
inline constexpr ScannerKind kTrackerKind = {kTracker, &Load, &Reload, &Transform, &Propagate};

}  // namespace scancal::robot_ball
