// The robot with a scanner passes the contract.
#include <algorithm>
#include "io/json_file.h"
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
  static void WriteLike(const Quantities& quantities, const Eigen::VectorXd& truth, Eigen::VectorXd* system) {
    if (quantities[Model::kHandEye + 3].role != Role::kEstimate) return;
    const Eigen::Vector3d turn = system->segment<3>(3), other = turn * (1 - 2 * M_PI / turn.norm());
    const Eigen::Vector3d like = truth.segment<3>(3);
    if ((other - like).norm() < (turn - like).norm()) system->segment<3>(3) = other;
  }

  static ContractData Make(const ContractOptions& options) { return MakeOf(options, Simulate(SceneOf(options))); }

  static Model ModelOf(const ContractOptions& options, const Simulated& robot) {
    Model model =
        robot_study::DeclaredModel(robot.data, SceneOf(options),
                                   options.influences ? robot_study::Noise::kDeclared : robot_study::Noise::kEstimated);
    if (robot.data.measured_in_world && robot.data.spheres.size() == 2)  // as the fit holds it
      model.quantity(Model::kHandEye + 3).role = Role::kHold;
    for (int k = 0; k < 6 && robot.data.hand_eye; ++k) {
      model.quantity(Model::kHandEye + k).role = Role::kHold;
      model.quantity(Model::kHandEye + k).value = NumbersOf(*robot.data.hand_eye)[k];
    }
    return model;
  }

  static ContractData MakeOf(const ContractOptions& options, Simulated robot) {
    Model model = ModelOf(options, robot);
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
    if (!robot.data.hand_eye) near.flange_from_scanner.translate(Eigen::Vector3d(0.3, -0.2, 0.1));
    const Result<std::vector<Station>> stations = StationsAt(robot.data, near);
    EXPECT_TRUE(stations.ok());
    for (const Station& station : *stations)
      for (const Model::View& pose : station.views) data.count += 3.0 * static_cast<double>(pose.balls.size());
    data.problem = MakeProblem(std::make_shared<const Model>(model), *stations);
    data.start = NominalStart(data.problem);
    near.link_errors = LinksOf(Eigen::VectorXd::Zero(kLinkNumbers * std::ssize(near.link_errors)));
    data.start.system = Truth(model.quantities(), near);
    WriteLike(model.quantities(), data.truth, &data.start.system);
    if (options.influences) Weigh(&data.problem, data.start);
    return data;
  }

  // The data as calibration.json keeps them, to the last digit.
  static Eigen::VectorXd RoundTrip(double noise) {
    return RoundTripOf(Simulate(SceneOf({noise, 1, true, false, false})));
  }

  static Eigen::VectorXd RoundTripOf(const Simulated& robot) {
    Declaration written;
    written.data = robot.data;
    written.u_of_spheres.resize(robot.data.spheres.size());
    Result<Declaration> read = FromJson(Json::parse(ToJson(written).dump()), "some.json");
    EXPECT_TRUE(read.ok()) << read.error().message;
    read->data.links = robot.data.links;  // of dataset.yaml
    read->data.measured_in_world = robot.data.measured_in_world;
    read->data.hand_eye = robot.data.hand_eye;
    const Model model = ModelOf({}, robot);
    const Result<Kinematics> start = InitialHandEye(read->data);
    const Result<JointFit> fit = FitJointly(read->data, model, start->flange_from_scanner);
    EXPECT_TRUE(fit.ok()) << fit.error().message;
    const Eigen::VectorXd truth = Truth(model.quantities(), robot.truth);
    Eigen::VectorXd estimate = fit->solution.fit.estimate.system;
    WriteLike(model.quantities(), truth, &estimate);
    return estimate - truth;
  }

  static std::string Refusal() { return RefusalOf(Simulate(SceneOf({}))); }

  static std::string RefusalOf(const Simulated& robot) {
    Model model = ModelOf({}, robot);
    model.quantity(Model::kLinks).role = Role::kEstimate;  // the base itself
    const Result<JointFit> fit = FitJointly(robot.data, model, robot.truth.flange_from_scanner);
    return fit.ok() ? "" : fit.error().message;
  }
};

// Other arrangements of the same arm, whose points are seen from wherever its poses are.
enum class Arrangement { kOneBall, kReflectors, kTwoReflectors, kOneReflector, kHeldHandEye };

template <Arrangement kArrangement>
struct ArrangedCase : RobotCase {
  static Simulated Robot(const ContractOptions& options) {
    Scene scene = SceneOf(options);
    scene.poses = 12;
    Simulated robot = Simulate(scene);
    Measurements& data = robot.data;
    Random random(options.seed, 2000);
    const auto draw = [&](double sigma) {
      const double x = random.Normal(), y = random.Normal();
      return Eigen::Vector3d(sigma * x, sigma * y, sigma * random.Normal());
    };
    if (kArrangement == Arrangement::kHeldHandEye) {
      data.hand_eye = robot.truth.flange_from_scanner;
      return robot;
    }
    data.spheres = {{"A", Eigen::Vector3d(0, 0, 0)}};
    if (kArrangement == Arrangement::kReflectors)
      data.spheres.insert(data.spheres.end(), {{"B", Eigen::Vector3d(80, 0, 0)}, {"C", Eigen::Vector3d(0, 60, 20)}});
    if (kArrangement == Arrangement::kTwoReflectors) data.spheres.push_back({"B", Eigen::Vector3d(80, 0, 0)});
    data.measured_in_world = kArrangement != Arrangement::kOneBall;
    if (data.measured_in_world) {  // a single reflector says nothing of the tool's turn, which is zero, two of a part
      robot.truth.flange_from_scanner = kArrangement == Arrangement::kOneReflector ? PoseOf({30, -20, 90, 0, 0, 0})
                                        : kArrangement == Arrangement::kTwoReflectors
                                            ? PoseOf({30, -20, 90, 0, -0.2, 0.3})
                                            : PoseOf({30, -20, 90, 0.1, -0.2, 0.3});
      robot.base_from_artifact = {PoseOf({2500, 300, 800, 0.1, 0.2, -2})};
      for (size_t s = 1; s < data.stations.size(); ++s)
        data.stations[0].views.insert(data.stations[0].views.end(), data.stations[s].views.begin(),
                                      data.stations[s].views.end());
      data.stations.resize(1);
    }
    std::vector<Eigen::Vector3d> points;
    for (const Model::Sphere& sphere : data.spheres) points.emplace_back(sphere.centre + draw(scene.u_spheres));
    const Kinematics flange{Eigen::Isometry3d::Identity(), robot.truth.link_errors};
    for (size_t s = 0; s < data.stations.size(); ++s) {
      const Eigen::Isometry3d& world = robot.base_from_artifact[s];
      for (Model::View& view : data.stations[s].views) {
        Eigen::Isometry3d moved = BaseFromScanner(data, flange, view);
        moved.translation() += draw(scene.repeatability);
        const Eigen::Vector3d tilt = draw(scene.repeatability_rotation);
        if (tilt.norm() > 0) moved.linear() = Eigen::AngleAxisd(tilt.norm(), tilt.normalized()) * moved.linear();
        const Eigen::Isometry3d tool = moved * robot.truth.flange_from_scanner;
        view.balls.clear();
        for (size_t k = 0; k < points.size(); ++k) {
          Model::SeenBall& seen = view.balls.emplace_back();
          seen.sphere = static_cast<int>(k);
          seen.centre =
              data.measured_in_world ? world.inverse() * (tool * points[k]) : tool.inverse() * (world * points[k]);
          seen.centre += draw(scene.ball_noise);
        }
      }
    }
    return robot;
  }
  static ContractData Make(const ContractOptions& options) { return MakeOf(options, Robot(options)); }
  static Eigen::VectorXd RoundTrip(double noise) { return RoundTripOf(Robot({noise, 1, true, false, false})); }
  static std::string Refusal() { return RefusalOf(Robot({})); }
};

INSTANTIATE_TYPED_TEST_SUITE_P(Robot, ModelContract, RobotCase);
using Arrangements =
    ::testing::Types<ArrangedCase<Arrangement::kOneBall>, ArrangedCase<Arrangement::kReflectors>,
                     ArrangedCase<Arrangement::kTwoReflectors>, ArrangedCase<Arrangement::kOneReflector>,
                     ArrangedCase<Arrangement::kHeldHandEye>>;
INSTANTIATE_TYPED_TEST_SUITE_P(RobotArranged, ModelContract, Arrangements);

// Whatever line the two lie on, and whichever number of the turn is then the open one.
TEST(RobotBallTest, TheTurnAboutTheLineThroughTwoReflectorsIsHeldByRank) {
  using Case = ArrangedCase<Arrangement::kTwoReflectors>;
  const Simulated robot = Case::Robot({});
  for (const bool along_y : {false, true}) {
    Measurements data = robot.data;
    if (along_y) data.spheres[1].centre = {0, 80, 0};
    const Result<Kinematics> start = InitialHandEye(data);
    ASSERT_TRUE(start.ok()) << start.error().message;
    const Result<JointFit> fit = FitJointly(data, Model(data.links, data.spheres, true), start->flange_from_scanner);
    ASSERT_TRUE(fit.ok()) << fit.error().message;
    EXPECT_EQ(fit->held_turn, std::vector<std::string>(1, "hand_eye_rx"));
    const Eigen::Isometry3d found = fit->Found().flange_from_scanner;
    EXPECT_LT((found * data.spheres[1].centre - robot.truth.flange_from_scanner * robot.data.spheres[1].centre).norm(),
              0.1);
  }
}

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
