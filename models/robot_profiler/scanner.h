// The robot with a line profiler as a Scanner, and what its dataset.yaml declares.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>
#include "io/result.h"
#include "models/chain/declare.h"
#include "models/robot_ball/scanner.h"
#include "models/robot_profiler.h"
#include "models/scanner.h"
#include "solver/calibrate.h"

namespace scancal::robot_profiler {

struct Profile {  // of a pose, on one plane
  size_t pose = 0;
  std::vector<double> y, z;  // mm; none where they were compressed before
  double count = 0;
  ProfileFactor factor = ProfileFactor::Zero();
};

struct Plane {
  std::string name;
  std::vector<Profile> profiles;
  double set_aside = 0;  // points off the line of their profile
};

struct Declaration {
  Dataset dataset;
  Arm arm;
  std::vector<Model::View> poses;  // without points, in the order in which they were taken
  std::vector<Plane> planes;
  Model model{{}};  // roles, values and u as declared
  std::vector<std::filesystem::path> files;
  std::vector<Sentence> warnings;
};

// Takes every key of the data set and reads its tables:
//
//     robot: {links: [...]}                    without it the poses are those of the flange
//     poses: poses.csv                         pose, q1 .. qn
//     targets: [{name: floor, scan: floor.csv}, ...]   pose, y, z: a plane each, y the depth
//     parameters: {links: hold, hand_eye_x: {estimate: 120, u: 5}}
//     influences: {noise_y: 0.02, repeatability: estimate, scale_y: 1e-4}
Result<Declaration> Declare(const Dataset& dataset);
// The same from what calibration.json keeps of poses and profiles.
Result<Declaration> Redeclare(const Dataset& dataset, Declaration read);

// A target per plane, its views as the profiles stand; where the planes start is not set.
std::vector<Model::Target> TargetsOf(const Declaration& declaration);

// Every plane through its points, as these values of the quantities see them.
void PlacePlanes(const Model& model, const std::vector<double>& values, std::vector<Model::Target>* planes);

struct JointFit {
  std::vector<Model::Target> planes;  // as they entered: where normal_1, normal_2 and distance start
  Solution solution;
};

// Where the hand-eye is not declared, as a value that is held or has a prior, its turn starts from the
// best of 24, no farther than 63 degrees from any. An Error names what the data do not determine.
Result<JointFit> FitJointly(const Model& model, std::vector<Model::Target> planes, const RefineChoice& choice);

class Scanner final : public scancal::Scanner {
 public:
  explicit Scanner(Declaration declaration) : declaration_(std::move(declaration)) {}
  std::string Describe() const override;
  const Dataset& dataset() const override { return declaration_.dataset; }
  std::vector<std::filesystem::path> Files() const override { return declaration_.files; }
  Result<Json> Data() const override;
  Result<Calibration> Calibrate(const RefineChoice& choice) const override;

 private:
  Declaration declaration_;
};

Result<std::unique_ptr<scancal::Scanner>> Load(const Dataset& dataset);
Result<std::unique_ptr<scancal::Scanner>> Reload(const Dataset& dataset, const Json& data, const std::string& file);
// Every point in the base; scan: the number of its plane.
Result<int64_t> Transform(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud);
inline constexpr ScannerKind kKind = {"robot-profiler", &Load, &Reload, &Transform, &robot_ball::Propagate};

}  // namespace scancal::robot_profiler
