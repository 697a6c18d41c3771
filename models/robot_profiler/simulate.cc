#include "models/robot_profiler/simulate.h"
#include <fmt/format.h>
#include <glog/logging.h>
#include "io/json_file.h"
#include "io/output_file.h"
#include "io/units.h"

namespace scancal::robot_profiler {
namespace {

constexpr uint64_t kLinkStream = uint64_t{1} << 32;

std::vector<Link> DrawErrors(const Scene& scene) {
  constexpr double kLength_mm = 0.3, kAngle_rad = 1e-3;
  const Model model(scene.links);
  Random random(scene.seed, kLinkStream);
  Eigen::VectorXd numbers = 0 * NumbersOf(scene.links);
  for (Eigen::Index k = 0; k < numbers.size(); ++k) {
    const Quantity& quantity = model.quantities()[Model::kLinks + static_cast<int>(k)];
    const double size = quantity.unit == Unit::kMm ? kLength_mm : kAngle_rad;
    if (quantity.role == Role::kEstimate) numbers[k] = size * random.Normal();
  }
  return LinksOf(numbers);
}

double Within(double limit, Random* random) { return limit * (2 * random->Uniform() - 1); }

// Before the robot, leaning towards it: its Z is the plane's normal.
Eigen::Isometry3d DrawPlane(int number, Random* random) {
  Eigen::Isometry3d plane = Eigen::Isometry3d::Identity();
  plane.translation() << 600 + Within(120, random), Within(250, random), 250 + Within(200, random);
  const double lean = (10 + 50 * random->Uniform()) * kDegree, heading = 2.4 * number + Within(0.5, random);
  plane.linear() =
      (Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(lean, Eigen::Vector3d::UnitY()))
          .toRotationMatrix();
  return plane;
}

// base_from_profiler that looks at the plane from within 30 degrees of its normal.
Eigen::Isometry3d DrawSight(const Eigen::Isometry3d& plane, Random* random) {
  const double depth = 110 + Within(20, random), around = 2 * Within(1, random) * 90 * kDegree;
  Eigen::Isometry3d sight = plane;
  sight = sight * Eigen::Translation3d(Within(60, random), Within(60, random), 0) *
          Eigen::AngleAxisd(around, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(Within(30, random) * kDegree, Eigen::Vector3d::UnitX()) *
          Eigen::AngleAxisd(Within(30, random) * kDegree, Eigen::Vector3d::UnitY());
  Eigen::Matrix3d look;  // x of the profiler along x, its depth down on the plane
  look << 1, 0, 0,       //
      0, 0, 1,           //
      0, -1, 0;
  sight.linear() = sight.linear() * look;
  return sight * Eigen::Translation3d(0, -depth, 0);
}

}  // namespace

Scene::Scene() : hand_eye(Eigen::Isometry3d::Identity()) {
  hand_eye.translation() << 45, -20, 110;
  Eigen::Matrix3d along;  // depth along the flange's Z
  along << 0, 0, 1,       //
      1, 0, 0,            //
      0, 1, 0;
  hand_eye.linear() = Eigen::AngleAxisd(0.35, Eigen::Vector3d(0.3, -0.5, 0.8).normalized()).toRotationMatrix() * along;
}

Simulated Simulate(const Scene& scene) {
  constexpr int kTries = 1000;
  Simulated result;
  result.link_errors = scene.link_errors.empty() ? DrawErrors(scene) : scene.link_errors;
  const std::vector<Link> truth = WithErrors(scene.links, result.link_errors);
  for (int t = 0; t < scene.planes; ++t) {
    Random random(scene.seed, static_cast<uint64_t>(t) + 1), noise(scene.noise_seed, static_cast<uint64_t>(t) + 1);
    const auto draw = [&](double sigma) {
      return Eigen::Vector3d(sigma * noise.Normal(), sigma * noise.Normal(), sigma * noise.Normal());
    };
    std::vector<Simulated::Reading>& readings = result.planes.emplace_back();
    Eigen::Isometry3d plane = DrawPlane(t, &random);
    for (int p = 0, tries = 0; p < scene.poses; ++tries) {
      CHECK_LT(tries, kTries) << "the robot does not reach the plane";
      if (p == 0) plane = DrawPlane(t, &random);
      const std::vector<double> joints =
          robot_ball::PlanJoints(scene.links, DrawSight(plane, &random) * scene.hand_eye.inverse(), &random);
      if (joints.empty()) continue;
      ++p;
      Model::View& pose = result.poses.emplace_back();
      pose.name = fmt::format("{}-{}", t + 1, p);
      pose.joints = joints;
      Eigen::Isometry3d flange = BaseFromFlange(truth, joints);
      flange.translation() += draw(scene.repeatability);
      const Eigen::Vector3d turn = draw(scene.repeatability_rotation);
      if (turn.norm() > 0)
        flange.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * flange.linear();
      const Eigen::Isometry3d plane_from_profiler = plane.inverse() * flange * scene.hand_eye;
      const Eigen::Vector3d origin = plane_from_profiler.translation(), y = plane_from_profiler.linear().col(1),
                            z = plane_from_profiler.linear().col(2);
      for (int i = 0; i < scene.points; ++i) {
        const double along = scene.points > 1 ? scene.line_length * (i / (scene.points - 1.0) - 0.5) : 0;
        const double depth = -(origin.z() + along * z.z()) / y.z();
        readings.push_back({result.poses.size() - 1, depth / (1 + scene.scale_y) + scene.noise * noise.Normal(),
                            along / (1 + scene.scale_z)});
      }
    }
  }
  return result;
}

Result<void> WriteSimulated(const Scene& scene, bool declare, const std::filesystem::path& folder) {
  if (scene.planes < 1 || scene.poses < 1 || scene.points < 2)
    return Error{"planes, poses: expected one or more of each; points: two or more"};
  for (const double noise : {scene.noise, scene.repeatability, scene.repeatability_rotation})
    if (!(noise >= 0)) return Error{"noise and repeatability: expected numbers that are not negative"};
  const Simulated robot = Simulate(scene);
  std::string yaml = fmt::format(
      "scancal: 1\nmodel: robot-profiler\nname: simulated profiler on a robot, seed {}\nunits: {{length: mm, angle: "
      "deg}}\n",
      scene.seed);
  yaml += "robot:\n  links:\n";
  for (const Link& link : scene.links)
    yaml += fmt::format("    - {{theta: {}, d: {}, a: {}, alpha: {}, beta: {}}}\n", link.theta / kDegree, link.d,
                        link.a, link.alpha / kDegree, link.beta / kDegree);
  yaml += "poses: poses.csv\n";
  if (declare) yaml += fmt::format("influences: {{noise_y: {}}}\n", scene.noise);
  yaml += "targets:\n";
  std::string poses = "pose,q1,q2,q3,q4,q5,q6\n";
  for (const Model::View& pose : robot.poses) {
    poses += pose.name;
    for (const double q : pose.joints) poses += fmt::format(",{}", q / kDegree);
    poses += "\n";
  }
  for (size_t t = 0; t < robot.planes.size(); ++t) {
    yaml += fmt::format("  - {{name: plane{0}, scan: plane{0}.csv}}\n", t + 1);
    std::string scan = "pose,y,z\n";
    for (const auto& [pose, y, z] : robot.planes[t]) scan += fmt::format("{},{},{}\n", robot.poses[pose].name, y, z);
    SCANCAL_RETURN_IF_ERROR(WriteFile(folder / fmt::format("plane{}.csv", t + 1), scan));
  }
  SCANCAL_RETURN_IF_ERROR(WriteFile(folder / "poses.csv", poses));
  Json truth = {{"units", "mm, rad"}, {"seed", scene.seed}};
  const Eigen::Matrix<double, 6, 1> hand_eye = robot_ball::NumbersOf(scene.hand_eye);
  const Model model(scene.links);
  const Eigen::VectorXd numbers = NumbersOf(robot.link_errors);
  for (int k = 0; k < 6; ++k) truth[model.quantities()[k].name] = hand_eye[k];
  for (int k = 0; k < numbers.size(); ++k) truth[model.quantities()[Model::kLinks + k].name] = numbers[k];
  SCANCAL_RETURN_IF_ERROR(WriteJson(folder / "truth.json", truth));
  return WriteFile(folder / "dataset.yaml", yaml);
}

}  // namespace scancal::robot_profiler
