// The line profiler on a robot: it passes the contract, finds its hand-eye from nothing, and says what it cannot tell.
#include <gmock/gmock.h>
#include <numbers>
#include "io/json_file.h"
#include "models/models.h"
#include "models/robot_profiler/scanner.h"
#include "models/robot_profiler/simulate.h"
#include "tests/io/temporary_folder.h"
#include "tests/model_contract.h"

namespace scancal::robot_profiler {
namespace {

using ::testing::HasSubstr;

// What is seen from the simulated poses, as targets of the model.
std::vector<Model::Target> TargetsOf(const Simulated& robot, bool compressed) {
  Declaration declaration;
  declaration.poses = robot.poses;
  for (const auto& readings : robot.planes) {
    Plane& plane = declaration.planes.emplace_back();
    plane.name = "plane" + std::to_string(declaration.planes.size());
    for (const Simulated::Reading& reading : readings) {
      if (plane.profiles.empty() || plane.profiles.back().pose != reading.pose)
        plane.profiles.push_back({reading.pose, {}, {}});
      Profile& profile = plane.profiles.back();
      profile.y.push_back(reading.y);
      profile.z.push_back(reading.z);
      profile.count = static_cast<double>(profile.y.size());
      profile.factor = Factor(profile.y, profile.z);
    }
  }
  std::vector<Model::Target> targets = robot_profiler::TargetsOf(declaration);
  for (size_t t = 0; t < targets.size() && !compressed; ++t)
    for (size_t v = 0; v < targets[t].views.size(); ++v) {
      const Profile& profile = declaration.planes[t].profiles[v];
      targets[t].views[v].points.clear();
      for (size_t i = 0; i < profile.y.size(); ++i)
        targets[t].views[v].points.push_back({1, profile.y[i], profile.z[i]});
    }
  return targets;
}

Eigen::VectorXd TruthOf(const Scene& scene, const Simulated& robot, const Model& model) {
  const Eigen::Matrix<double, 6, 1> hand_eye = robot_ball::NumbersOf(scene.hand_eye);
  const Eigen::VectorXd links = NumbersOf(robot.link_errors);
  std::vector<double> truth;
  for (int k = 0; k < std::ssize(model.quantities()); ++k) {
    const Quantity& quantity = model.quantities()[k];
    if (quantity.scope != Scope::kSystem || quantity.role != Role::kEstimate) continue;
    truth.push_back(k < 6 ? hand_eye[k] : links[k - Model::kLinks]);
  }
  return Eigen::VectorXd::Map(truth.data(), std::ssize(truth));
}

Scene SmallScene() {
  Scene scene;
  scene.planes = 6;
  scene.poses = 10;
  scene.points = 12;
  return scene;
}

struct ProfilerCase {
  static constexpr double kNoise = 0.3;  // mm; a hundredth of it is to be far above the rounding of base coordinates
  static constexpr double kTruthTolerance = 1e-7;  // mm, rad
  static constexpr const char* kRefusedName = "hand_eye";
  static constexpr double kScaleU = 2e-4, kRepeatability = 0.03, kTurn = 2e-4, kPriorU = 0.1;
  static constexpr int kPriorOf = Model::kLinks + kLinkNumbers + 2;  // a_2

  static ContractData Make(const ContractOptions& options) {
    Scene scene = SmallScene();
    scene.noise = kNoise * options.noise;
    scene.noise_seed = options.seed;
    Random random(options.seed, 1000);
    Model model(scene.links);
    if (options.influences) {
      scene.scale_y = kScaleU * random.Normal();
      scene.repeatability = kRepeatability;
      scene.repeatability_rotation = kTurn;
    }
    const Simulated robot = Simulate(scene);
    const Eigen::VectorXd truth = TruthOf(scene, robot, model);
    if (options.influences) {
      const auto consider = [&](int k, double u) {
        model.quantity(k).role = Role::kConsider;
        model.quantity(k).u = u;
      };
      consider(Model::kScaleY, kScaleU);
      consider(Model::kNoiseY, scene.noise);
      for (int k = 0; k < 3; ++k) consider(Model::kRepeatability + k, kRepeatability);
      for (int k = 3; k < 6; ++k) consider(Model::kRepeatability + k, kTurn);
      Quantity& prior = model.quantity(kPriorOf);
      prior.u = kPriorU;
      prior.value = robot.link_errors[1].a + kPriorU * random.Normal();
    }
    std::vector<Model::Target> targets = TargetsOf(robot, options.compressed);
    std::vector<double> values;
    for (const Quantity& quantity : model.quantities()) values.push_back(quantity.value);
    Eigen::Matrix<double, 6, 1>::Map(values.data()) = robot_ball::NumbersOf(scene.hand_eye);
    for (int k = 0; k < 6; ++k) values[static_cast<size_t>(k)] += k < 3 ? 0.3 : 2e-3;
    PlacePlanes(model, values, &targets);
    if (options.reversed) {
      std::reverse(targets.begin(), targets.end());
      for (Model::Target& target : targets) std::reverse(target.views.begin(), target.views.end());
    }
    ContractData data;
    for (const Model::Target& target : targets)
      for (const Model::View& view : target.views) data.count += view.count;
    data.problem = MakeProblem(std::make_shared<const Model>(model), targets);
    if (options.influences) {
      data.problem.WeighEqually(scene.noise);
    }
    data.start = NominalStart(data.problem);
    SetValues(data.problem, values, 0, &data.start);
    data.truth = truth;
    return data;
  }

  static Result<Calibration> Calibrated(const Scene& scene) {
    const TemporaryFolder folder;
    const Result<void> written = WriteSimulated(scene, false, folder.path());
    if (!written.ok()) return written.error();
    SCANCAL_ASSIGN_OR_RETURN(const Dataset dataset, ReadDataset(folder.path()));
    SCANCAL_ASSIGN_OR_RETURN(const auto scanner, (*FindScannerKind(dataset))->load(dataset));
    return scanner->Calibrate({});
  }

  static Eigen::VectorXd RoundTrip(double noise) {
    Scene scene = SmallScene();
    scene.noise = kNoise * noise;
    const Result<Calibration> result = Calibrated(scene);
    EXPECT_TRUE(result.ok() && result->ok());
    Eigen::VectorXd error = -TruthOf(scene, Simulate(scene), Model(scene.links));
    Eigen::Index e = 0;
    for (const std::string& name : result->estimated) error[e++] += result->Find(name)->value;
    return error;
  }

  // One plane leaves the hand-eye free to slide along it.
  static std::string Refusal() {
    Scene scene = SmallScene();
    scene.planes = 1;
    const Result<Calibration> result = Calibrated(scene);
    return result.ok() ? "" : result.error().message;
  }
};

INSTANTIATE_TYPED_TEST_SUITE_P(Profiler, ModelContract, ProfilerCase);

// The profiler may be mounted any way round.
TEST(RobotProfiler, FindsItsHandEyeFromNothing) {
  for (const double turn : {0.0, 1.0, 2.0, std::numbers::pi}) {
    Scene scene = SmallScene();
    scene.hand_eye.linear() = Eigen::AngleAxisd(turn, Eigen::Vector3d(1, 0.4, -0.2).normalized()).toRotationMatrix() *
                              scene.hand_eye.linear();
    const Result<Calibration> result = ProfilerCase::Calibrated(scene);
    ASSERT_TRUE(result.ok()) << result.error().message;
    EXPECT_TRUE(result->ok()) << result->unreliable.front().english;
    const Eigen::VectorXd truth = robot_ball::NumbersOf(scene.hand_eye);
    Eigen::Matrix<double, 6, 1> found;
    for (int k = 0; k < 6; ++k) found[k] = result->Find(Model(scene.links).quantities()[k].name)->value;
    EXPECT_LT(found.tail<3>().norm(), std::numbers::pi + 1e-9);
    const Eigen::Isometry3d apart = robot_ball::PoseOf(found).inverse() * scene.hand_eye;
    EXPECT_LT(apart.translation().norm(), 0.5) << turn;
    EXPECT_LT(Eigen::AngleAxisd(apart.linear()).angle(), 3e-3) << turn;
  }
}

TEST(RobotProfiler, WhatPosesErrByIsFoundAndStated) {
  Scene scene = SmallScene();
  scene.planes = 8;
  scene.poses = 20;
  scene.repeatability = 0.05;
  const Result<Calibration> result = ProfilerCase::Calibrated(scene);
  ASSERT_TRUE(result.ok()) << result.error().message;
  const auto line = std::find_if(result->influences.begin(), result->influences.end(),
                                 [](const Influence& each) { return each.source == "repeatability"; });
  ASSERT_NE(line, result->influences.end());
  EXPECT_NEAR(line->u, 0.05, 0.015);
}

TEST(RobotProfiler, TheSameFromItsOwnData) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteSimulated(SmallScene(), false, folder.path()).ok());
  const auto dataset = ReadDataset(folder.path());
  const auto scanner = Load(*dataset);
  ASSERT_TRUE(scanner.ok()) << scanner.error().message;
  const Result<Json> data = (*scanner)->Data();
  const auto again = Reload(*dataset, *data, "calibration.json");
  ASSERT_TRUE(again.ok()) << again.error().message;
  const Result<Calibration> one = (*scanner)->Calibrate({}), other = (*again)->Calibrate({});
  ASSERT_TRUE(one.ok() && other.ok());
  for (size_t k = 0; k < one->parameters.size(); ++k) {
    EXPECT_EQ(one->parameters[k].value, other->parameters[k].value);
    EXPECT_EQ(one->parameters[k].u, other->parameters[k].u);
  }
}

TEST(RobotProfiler, RefusesWhatDoesNotFit) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteSimulated(SmallScene(), false, folder.path()).ok());
  folder.Write("plane2.csv", "pose,y,z\n2-1,100,0\n9-9,100,0\n");
  const auto scanner = Load(*ReadDataset(folder.path()));
  ASSERT_FALSE(scanner.ok());
  EXPECT_THAT(scanner.error().message, HasSubstr("plane2.csv:3:1: pose: found \"9-9\", which"));
}

}  // namespace
}  // namespace scancal::robot_profiler
