// The robot with a scanner passes the contract.
#include <algorithm>
#include "models/robot_ball/fit.h"
#include "models/robot_ball/scanner.h"
#include "models/robot_ball/simulate.h"
#include "models/robot_ball/start.h"
#include "solver/random.h"
#include "solver/weigh.h"
#include "tests/model_contract.h"
#include "tests/robot_study/declared.h"

namespace scancal::robot_ball {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

struct RobotCase {
  static constexpr double kNoise = 0.035;
  static constexpr double kTruthTolerance = 1e-8;  // mm, rad
  static constexpr const char* kRefusedName = "theta_1";
  static constexpr double kPriorU = 0.05;
  static constexpr int kPriorOf = Model::kLinks + kLinkNumbers + 2;  // a_2

  // Errors only of what is estimated by default: the truth is then exact, whatever the gauge.
  static Scene SceneOf(const ContractOptions& options) {
    Scene scene;
    scene.stations = 4;
    scene.poses = 6;
    scene.translations = scene.check_positions = 0;
    scene.ball_noise = kNoise * options.noise;
    scene.repeatability = options.influences ? 0.04 : 0;
    scene.repeatability_rotation = options.influences ? 2e-4 : 0;
    scene.u_spheres = options.influences ? 0.01 : 0;
    scene.noise_seed = options.seed;
    const Model model(scene.links, {});
    Eigen::VectorXd errors = NumbersOf(scene.link_errors);
    for (Eigen::Index k = 0; k < errors.size(); ++k)
      if (model.quantities()[Model::kLinks + k].role != Role::kEstimate) errors[k] = 0;
    scene.link_errors = LinksOf(errors);
    return scene;
  }

  static Eigen::VectorXd Truth(const Quantities& quantities, const Kinematics& truth) {
    std::vector<double> all(quantities.size());
    Vector6d::Map(&all[Model::kHandEye]) = NumbersOf(truth.flange_from_scanner);
    Eigen::VectorXd::Map(&all[Model::kLinks], kLinkNumbers * std::ssize(truth.link_errors)) =
        NumbersOf(truth.link_errors);
    std::vector<double> estimated;
    for (size_t k = 0; k < quantities.size(); ++k)
      if (quantities[k].scope == Scope::kSystem && quantities[k].role == Role::kEstimate) estimated.push_back(all[k]);
    return Eigen::VectorXd::Map(estimated.data(), std::ssize(estimated));
  }

  // A turn by nearly pi has two rotation vectors: the one that the truth is written in.
  static void WriteLike(const Eigen::VectorXd& truth, Eigen::VectorXd* system) {
    const Eigen::Vector3d turn = system->segment<3>(3), other = turn * (1 - 2 * M_PI / turn.norm());
    const Eigen::Vector3d like = truth.segment<3>(3);
    if ((other - like).norm() < (turn - like).norm()) system->segment<3>(3) = other;
  }

  static ContractData Make(const ContractOptions& options) {
    const Scene scene = SceneOf(options);
    Simulated robot = Simulate(scene);
    Model model = robot_study::DeclaredModel(
        robot.data, scene, options.influences ? robot_study::Noise::kDeclared : robot_study::Noise::kEstimated);
    ContractData data;
    data.truth = Truth(model.quantities(), robot.truth);
    if (options.influences) {
      Quantity& prior = model.quantity(kPriorOf);
      prior.u = kPriorU;
      prior.value = robot.truth.link_errors[1].a + prior.u * Random(options.seed, 1000).Normal();
    }
    if (options.reversed) {
      std::reverse(robot.data.stations.begin(), robot.data.stations.end());
      for (Station& station : robot.data.stations) {
        std::reverse(station.views.begin(), station.views.end());
        for (Model::View& pose : station.views) std::reverse(pose.balls.begin(), pose.balls.end());
      }
    }
    // From the truth moved a little: the same for any order.
    Kinematics near = robot.truth;
    near.flange_from_scanner.translate(Eigen::Vector3d(0.3, -0.2, 0.1));
    const Result<std::vector<Station>> stations = StationsAt(robot.data, near);
    EXPECT_TRUE(stations.ok());
    for (const Station& station : *stations)
      for (const Model::View& pose : station.views) data.count += 3.0 * static_cast<double>(pose.balls.size());
    data.problem = MakeProblem(std::make_shared<const Model>(model), *stations);
    data.start = NominalStart(data.problem);
    data.start.system.head<6>() = NumbersOf(near.flange_from_scanner);
    WriteLike(data.truth, &data.start.system);
    if (options.influences) Weigh(&data.problem, data.start);
    return data;
  }

  // The data as calibration.json keeps them, to the last digit.
  static Eigen::VectorXd RoundTrip(double noise) {
    const Simulated robot = Simulate(SceneOf({noise, 1, true, false, false}));
    Declaration written;
    written.data = robot.data;
    written.u_of_spheres.resize(robot.data.spheres.size());
    Result<Declaration> read = FromJson(Json::parse(ToJson(written).dump()), "some.json");
    EXPECT_TRUE(read.ok()) << read.error().message;
    read->data.links = robot.data.links;  // of dataset.yaml
    const Model model(read->data.links, read->data.spheres);
    const Result<Kinematics> start = InitialHandEye(read->data);
    const Result<JointFit> fit = FitJointly(read->data, model, start->flange_from_scanner);
    EXPECT_TRUE(fit.ok()) << fit.error().message;
    const Eigen::VectorXd truth = Truth(model.quantities(), robot.truth);
    Eigen::VectorXd estimate = fit->solution.fit.estimate.system;
    WriteLike(truth, &estimate);
    return estimate - truth;
  }

  static std::string Refusal() {
    const Simulated robot = Simulate(SceneOf({}));
    Model model(robot.data.links, robot.data.spheres);
    model.quantity(Model::kLinks).role = Role::kEstimate;  // the base itself
    const Result<JointFit> fit = FitJointly(robot.data, model, robot.truth.flange_from_scanner);
    return fit.ok() ? "" : fit.error().message;
  }
};

INSTANTIATE_TYPED_TEST_SUITE_P(Robot, ModelContract, RobotCase);

TEST(RobotBallTest, DenseAndSparseEliminationAgree) {
  ContractOptions options;
  options.influences = true;
  const ContractData data = RobotCase::Make(options);
  const Fit dense = Refine(data.problem, data.start, {100, Elimination::kDense}),
            sparse = Refine(data.problem, data.start, {100, Elimination::kSparse});
  ASSERT_TRUE(dense.converged && sparse.converged);
  const Eigen::VectorXd u =
      InverseInformation(Linearize(data.problem, dense.estimate, Storey::kViews)).diagonal().cwiseSqrt();
  EXPECT_LT(((dense.estimate.system - sparse.estimate.system).array() / u.array()).abs().maxCoeff(), 1e-8);
}

// Poses that see few balls and poses that see all, all in a plane, and correlated noise.
TEST(RobotBallTest, FourBallsOfAPoseStandForAll) {
  for (const bool flat : {false, true}) {
    Scene scene = RobotCase::SceneOf({});
    Simulated robot = Simulate(scene);
    if (flat)
      for (Model::Sphere& sphere : robot.data.spheres) sphere.centre[2] = 0.1 * sphere.centre[0] - 3;
    robot.data.stations[0].views[0].balls.resize(1);
    robot.data.stations[0].views[1].balls.resize(2);
    const Model model = robot_study::DeclaredModel(robot.data, scene, robot_study::Noise::kDeclared);
    Kinematics near = robot.truth;
    near.flange_from_scanner.translate(Eigen::Vector3d(0.3, -0.2, 0.1));
    const Result<std::vector<Station>> stations = StationsAt(robot.data, near);
    ASSERT_TRUE(stations.ok()) << stations.error().message;
    Problem problem = MakeProblem(std::make_shared<const Model>(model), *stations);
    Estimate at = NominalStart(problem);
    at.system.head<6>() = NumbersOf(near.flange_from_scanner);
    at.targets[1][4] = 0.01;
    Weigh(&problem, at);
    ASSERT_TRUE(problem.NodesSuffice());
    const Block& of_all = problem.targets[2].nodes[0];
    EXPECT_EQ(of_all.rows->points(), std::min(flat ? 3 : 4, problem.targets[2].views[0].rows->points()));
    const Linearization views = Linearize(problem, at, Storey::kViews), nodes = Linearize(problem, at, Storey::kNodes);
    EXPECT_NEAR(nodes.cost, views.cost, 1e-11 * views.cost);
    EXPECT_LT((GaussNewtonStep(nodes).system - GaussNewtonStep(views).system).norm(),
              1e-9 * GaussNewtonStep(views).system.norm());
    EXPECT_LT((InverseInformation(nodes) - InverseInformation(views)).norm(), 1e-8 * InverseInformation(views).norm());
  }
}

TEST(RobotBallTest, SixJointsLeaveTwentyFourNumbersAndNoMore) {
  const Scene scene = RobotCase::SceneOf({});
  const Simulated robot = Simulate(scene);
  Model model(robot.data.links, robot.data.spheres);
  const auto estimated = [&] {
    return std::count_if(model.quantities().begin(), model.quantities().end(), [](const Quantity& quantity) {
      return quantity.scope == Scope::kSystem && quantity.role == Role::kEstimate;
    });
  };
  EXPECT_EQ(estimated(), 24);
  for (size_t link = 0; link < 6; ++link)  // all 31: beta where the next axis is parallel
    for (int e = 0; e < kLinkNumbers; ++e)
      if (e < 4 || link == 1)
        model.quantity(Model::kLinks + kLinkNumbers * static_cast<int>(link) + e).role = Role::kEstimate;
  EXPECT_EQ(estimated(), 31);
  for (const bool at_truth : {true, false}) {  // and off the solution
    Kinematics setup = robot.truth;
    if (!at_truth) setup.flange_from_scanner.translate(Eigen::Vector3d(5, -3, 2));
    const Problem problem = MakeProblem(std::make_shared<const Model>(model), *StationsAt(robot.data, setup));
    Estimate at = NominalStart(problem);
    at.system.head<6>() = NumbersOf(setup.flange_from_scanner);
    const Observability seen = Observe(problem, Linearize(problem, at, Storey::kViews));
    EXPECT_EQ((seen.singular.array() > 1e-9).count(), 24) << seen.singular.transpose();
  }
}

}  // namespace
}  // namespace scancal::robot_ball
