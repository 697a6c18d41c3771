// A ball on a robot's flange: its fit, how well it sits, and the scanner around them.
#include "models/flange_ball/scanner.h"
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <cmath>
#include <sstream>
#include "io/json_file.h"
#include "tests/io/temporary_folder.h"
#include "tests/models/flange_ball/scene.h"

namespace scancal::flange_ball {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kSpacing = 50;
constexpr int kTheta6 = Model::kLinks + 5 * kLinkNumbers, kTheta7 = kTheta6 + kLinkNumbers;

Model ModelOf(const Scene& scene) {
  Model model(scene.nominal);
  Quantity& spacing = model.quantity(Model::kSpacing);
  spacing.role = Role::kConsider;
  spacing.value = kSpacing;
  spacing.u = 0.05;
  return model;
}

// The last tool of the scene is held out.
Scanner ScannerOf(const Scene& scene) {
  Declaration declaration;
  declaration.model = ModelOf(scene);
  return {declaration, {scene.tools.begin(), scene.tools.end() - 1}, {scene.tools.back()}};
}

std::string Refusal(const Model& model, const Scene& scene) {
  const Result<Solution> solution = FitJointly(model, scene.tools);
  return solution.ok() ? "" : solution.error().message;
}

TEST(FlangeBallTest, AnExactRobotsBallIsFoundAtOnce) {
  Scene scene = CleanScene({});
  const Robot found = FitBall(scene.truth.links, scene.tools);
  EXPECT_LT((found.ball - scene.truth.ball).norm(), 1e-9);
  const Seating seating = SeatingOf(found, scene.tools[0]);
  EXPECT_LT(seating.spread, 1e-9);
  EXPECT_NEAR(seating.spacing, kSpacing, 1e-9);
}

// One joint: the ball goes round it, 100 mm away.
TEST(FlangeBallTest, HowWellItSitsIsTheMeanDistanceFromTheMean) {
  const Robot robot{{Link{}}, {100, 0, 0}};
  Model::Target tool;
  tool.views = {{{0}, 0}, {{M_PI / 2}, 0}, {{M_PI}, 1}, {{-M_PI / 2}, 1}, {{M_PI}, 1}, {{-M_PI / 2}, 1}};
  const Seating seating = SeatingOf(robot, tool);
  EXPECT_NEAR(seating.spread, 100 / std::sqrt(2), 1e-12);  // of every pose
  EXPECT_NEAR(seating.spacing, 100 * std::sqrt(2), 1e-12);
}

// A robot twice as long would do as well, and one of no size no better: with noise too.
TEST(FlangeBallTest, ItsSizeIsTheSpacingsAlone) {
  const Scene scene = MakeScene({.seat = 0.3});
  Model model = ModelOf(scene);
  const Robot robot = RobotOf(scene.nominal, *FitJointly(model, scene.tools));
  model.quantity(Model::kSpacing).value = 1.02 * kSpacing;
  const Robot longer = RobotOf(scene.nominal, *FitJointly(model, scene.tools));
  for (size_t k = 1; k + 1 < robot.links.size(); ++k) {
    EXPECT_NEAR(longer.links[k].theta, robot.links[k].theta, 1e-9);
    EXPECT_NEAR(longer.links[k].alpha, robot.links[k].alpha, 1e-9);
    EXPECT_NEAR(longer.links[k].a, 1.02 * robot.links[k].a, 1e-7);
    EXPECT_NEAR(longer.links[k].d, 1.02 * robot.links[k].d, 1e-7);
  }
  model.quantity(Model::kSpacing).role = Role::kEstimate;  // with its u as the prior
  const Solution solution = *FitJointly(model, scene.tools);
  const std::vector<double> values = Values(solution.problem, solution.fit.estimate, 0);
  EXPECT_NEAR(values[Model::kSpacing], 1.02 * kSpacing, 1e-9);
}

TEST(FlangeBallTest, WhatNoToolTellsIsRefusedByName) {
  const Scene scene = MakeScene({.seat = 0.3});
  for (const int k : {0 + Model::kLinks, Model::kLinks + 1, kTheta7, kTheta7 + 1, kTheta7 + 2, kTheta7 + 3}) {
    Model model = ModelOf(scene);
    model.quantity(k).role = Role::kEstimate;
    EXPECT_THAT(Refusal(model, scene), AllOf(HasSubstr(model.quantities()[k].name), HasSubstr("not determined")));
  }
  Model free = ModelOf(scene);
  free.quantity(Model::kSpacing).role = Role::kEstimate;
  free.quantity(Model::kSpacing).u = 0;
  EXPECT_THAT(Refusal(free, scene), AllOf(HasSubstr("spacing"), HasSubstr("not determined")));
  EXPECT_EQ(Refusal(ModelOf(scene), scene), "");
}

TEST(FlangeBallTest, TheScannerFindsTheRobotAndChecksItWhereItWasNot) {
  const double seat = 0.1;
  const Scene scene = MakeScene({.poses = 40, .seat = seat});
  const Scanner scanner = ScannerOf(scene);
  const Result<Calibration> result = scanner.Calibrate({});
  ASSERT_TRUE(result.ok()) << result.error().message;
  EXPECT_THAT(result->unreliable, IsEmpty());
  EXPECT_THAT(result->warnings, IsEmpty());
  const Eigen::VectorXd truth = TruthOf(scene, ModelOf(scene));
  for (size_t k = 0; k < result->estimated.size(); ++k) {
    const Parameter& parameter = *result->Find(result->estimated[k]);
    EXPECT_NEAR(parameter.value, truth[static_cast<Eigen::Index>(k)], 4 * parameter.u) << parameter.name;
  }
  ASSERT_EQ(result->check.after.size(), 1U);
  EXPECT_LT(std::abs(result->check.after[0]), 0.2);
  EXPECT_GT(std::abs(result->check.before[0]), std::abs(result->check.after[0]));
  // A ball that strays by 0.1 mm along each axis lies 0.16 mm off on average, known to 0.42 / sqrt(80) of that.
  const double expected = seat * std::sqrt(8 / M_PI);
  const double spread = result->targets[0].geometry.at("spread")[0];
  EXPECT_NEAR(spread, expected, 4 * 0.42 / std::sqrt(80) * expected);
}

TEST(FlangeBallTest, TheComparisonHoldsTheLastToolOut) {
  const Scene scene = MakeScene({});
  const Result<Comparison> comparison = ScannerOf(scene).Compare({});
  ASSERT_TRUE(comparison.ok()) << comparison.error().message;
  ASSERT_EQ(comparison->rows.size(), 2U);
  for (const ComparisonRow& row : comparison->rows) {
    ASSERT_EQ(row.cells.size(), comparison->columns.size());
    EXPECT_DOUBLE_EQ(*row.cells[0].value, (*row.cells[4].value + *row.cells[5].value) / 2);
    EXPECT_EQ(*row.cells[1].value, *row.cells[6].value);
  }
  const Robot nominal = FitBall(scene.nominal, {scene.tools[0], scene.tools[1]});
  EXPECT_DOUBLE_EQ(*comparison->rows[0].cells[1].value, SeatingOf(nominal, scene.tools[2]).spread);
  EXPECT_LT(*comparison->rows[1].cells[1].value, 0.2 * *comparison->rows[0].cells[1].value);
}

TEST(FlangeBallTest, ABallOnTheLastAxisIsToldOf) {
  const Scene scene = MakeScene({.ball = {0.3, 0.2, 120}});
  Declaration declaration;
  declaration.model = ModelOf(scene);
  const auto free = Scanner(declaration, scene.tools, {}).Calibrate({});
  ASSERT_TRUE(free.ok()) << free.error().message;
  EXPECT_THAT(free->warnings, ::testing::Contains(HasSubstr("hold theta_6 and alpha_6")));
  EXPECT_GT(free->Find("ball_z")->u, 1);
  declaration.model.quantity(kTheta6).role = declaration.model.quantity(kTheta6 + 3).role = Role::kHold;
  const auto held = Scanner(declaration, scene.tools, {}).Calibrate({});
  ASSERT_TRUE(held.ok()) << held.error().message;
  EXPECT_THAT(held->warnings, IsEmpty());
  EXPECT_LT(held->Find("ball_z")->u, 0.5);
}

class FlangeBallFilesTest : public ::testing::Test {
 protected:
  FlangeBallFilesTest() {
    std::string yaml = "scancal: 1\nmodel: flange-ball\nunits: {length: mm, angle: rad}\nrobot:\n  links:\n";
    for (const Link& link : scene_.nominal)
      yaml += fmt::format("    - {{d: {:.17g}, a: {:.17g}, alpha: {:.17g}}}\n", link.d, link.a, link.alpha);
    yaml += "columns: [q1, q2, q3, q4, q5, q6, q7]\nparameters: {spacing: {consider: 50, u: 0.05}}\ntargets:\n";
    for (const Model::Target& tool : scene_.tools) {
      if (&tool == &scene_.tools.back()) yaml += "check:\n";
      for (const int s : {0, 1}) {
        std::string table;
        for (const Model::View& view : tool.views)
          if (view.socket == s) table += fmt::format("{:.17g}\n", fmt::join(view.joints, ","));
        folder_.Write(fmt::format("{}_{}.csv", tool.name, s), table);
      }
      yaml += fmt::format("  - {{name: {0}, sockets: [{0}_0.csv, {0}_1.csv]}}\n", tool.name);
    }
    folder_.Write("dataset.yaml", yaml);
    dataset_ = *ReadDataset(folder_.path());
    scanner_ = *kKind.load(dataset_);
  }

  const Scene scene_ = MakeScene({.seat = 0.3});
  const TemporaryFolder folder_;
  Dataset dataset_;
  std::unique_ptr<scancal::Scanner> scanner_;
};

TEST_F(FlangeBallFilesTest, AResultIsRecomputedToTheLastDigit) {
  EXPECT_EQ(scanner_->Files().size(), 7U);
  const Json data = Json::parse(scanner_->Data()->dump());
  const auto again = kKind.reload(dataset_, data, "calibration.json");
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_EQ((*again)->Files().size(), 1U);
  const Calibration first = *scanner_->Calibrate({}), second = *(*again)->Calibrate({});
  ASSERT_EQ(first.parameters.size(), second.parameters.size());
  for (size_t k = 0; k < first.parameters.size(); ++k) {
    EXPECT_EQ(first.parameters[k].value, second.parameters[k].value) << first.parameters[k].name;
    EXPECT_EQ(first.parameters[k].u, second.parameters[k].u) << first.parameters[k].name;
  }
  EXPECT_EQ(first.check.after, second.check.after);
}

TEST_F(FlangeBallFilesTest, DamagedDataOfAResultAreRefused) {
  const Json sound = *scanner_->Data();
  const auto message = [&](const Json& data) {
    const auto again = kKind.reload(dataset_, data, "calibration.json");
    return again.ok() ? "" : again.error().message;
  };
  Json data = sound;
  data["targets"][1]["sockets"][0][3].erase(6);
  EXPECT_THAT(message(data), HasSubstr("calibration.json: data: targets: expected the joint angles"));
  data = sound;
  data["check"][0]["name"] = "elsewhere";
  EXPECT_THAT(message(data), HasSubstr("data: check: expected"));
  data = sound;
  data["targets"].erase(0);
  EXPECT_THAT(message(data), HasSubstr("data: targets: expected"));
  data = sound;
  data["targets"][0]["sockets"][1][0][2] = "0.3";
  EXPECT_THAT(message(data), HasSubstr("data: targets: expected"));
  EXPECT_EQ(message(sound), "");
}

TEST_F(FlangeBallFilesTest, TheBallOfEveryPoseIsWrittenInTheBase) {
  const Calibration calibration = *scanner_->Calibrate({});
  {
    auto cloud = *CreatePointCloud(folder_.path() / "balls.csv");
    const auto written = kKind.transform(dataset_, calibration, cloud.get());
    ASSERT_TRUE(written.ok()) << written.error().message;
    EXPECT_EQ(*written, 60);
    ASSERT_TRUE(cloud->Commit().ok());
  }
  std::istringstream lines(folder_.Read("balls.csv"));
  std::string header;
  std::getline(lines, header);
  Eigen::Vector3d p;
  int scan = -1;
  char comma = ',';
  ASSERT_TRUE(lines >> p.x() >> comma >> p.y() >> comma >> p.z() >> comma >> scan);
  EXPECT_EQ(scan, 0);
  // The base is the nominal one: what theta_1 and d_1 say.
  EXPECT_LT((p - scene_.truth.InBase(scene_.tools[0].views[0])).norm(), 3);
  EXPECT_GT(p.norm(), 100);
}

TEST_F(FlangeBallFilesTest, WhatTheModelCannotDoIsSaid) {
  EXPECT_THAT(scanner_->WriteSurface("surface.csv").error().message,
              HasSubstr("surface: the model flange-ball searches no grid"));
  EXPECT_THAT(kKind.Propagate({}, {}, false).error().message, HasSubstr("the model flange-ball gives no uncertainty"));
  EXPECT_THAT(scanner_->Calibrate({"plane"}).error().message, HasSubstr("found \"plane\""));
  auto cloud = *CreatePointCloud(folder_.path() / "balls.csv");
  EXPECT_THAT(kKind.transform(dataset_, {}, cloud.get()).error().message, HasSubstr("has no parameter"));
}

TEST(FlangeBallTest, ItsTablesSayWhatTheResultSays) {
  const Scene scene = MakeScene({});
  const Result<Calibration> calibration = ScannerOf(scene).Calibrate({});
  ASSERT_TRUE(calibration.ok()) << calibration.error().message;
  Robot robot{scene.nominal, {}};
  for (int k = 0; k < 3; ++k) robot.ball[k] = calibration->Find(std::string("ball_") + "xyz"[k])->value;
  for (size_t k = 0; k < robot.links.size(); ++k) {
    const auto add = [&](const std::string& name, double* number) {
      const Parameter& parameter = *calibration->Find(name + std::to_string(k + 1));
      EXPECT_EQ(parameter.nominal, *number);
      *number += parameter.value;
    };
    Link& link = robot.links[k];
    add("theta_", &link.theta);
    add("d_", &link.d);
    add("a_", &link.a);
    add("alpha_", &link.alpha);
    add("beta_", &link.beta);
  }
  for (size_t t = 0; t + 1 < scene.tools.size(); ++t) {
    const TargetSummary& target = calibration->targets[t];
    const NumberTable &poses = target.residual_tables.at("poses"), &balls = target.residual_tables.at("balls");
    ASSERT_EQ(poses.rows.size(), scene.tools[t].views.size());
    ASSERT_EQ(balls.rows.size(), poses.rows.size());
    double squares = 0;
    for (size_t v = 0; v < poses.rows.size(); ++v) {
      const Model::View& view = scene.tools[t].views[v];
      EXPECT_EQ(std::vector(poses.rows[v].begin(), poses.rows[v].begin() + 7), view.joints);
      const Eigen::Vector3d flange = robot.FlangeAt(view).translation();
      EXPECT_LT((Eigen::Vector3d::Map(&poses.rows[v][7]) - flange).norm(), 1e-9);
      EXPECT_EQ(poses.rows[v][10], view.socket);
      const double square = Eigen::Vector3d::Map(&balls.rows[v][1]).squaredNorm();
      EXPECT_NEAR(poses.rows[v][11], std::sqrt(square / 3), 1e-12);
      squares += square;
      const std::vector<double>& sight = target.scene.at("views").rows[v];
      EXPECT_LT((Eigen::Vector3d::Map(&sight[0]) - flange).norm(), 1e-9);
      EXPECT_LT((Eigen::Vector3d::Map(&sight[3]) - robot.InBase(view)).norm(), 1e-9);
    }
    EXPECT_NEAR(std::sqrt(squares / 3 / static_cast<double>(poses.rows.size())), target.rms, 1e-9);
    const auto& sockets = target.scene.at("outline").rows;
    EXPECT_NEAR((Eigen::Vector3d::Map(&sockets[1][0]) - Eigen::Vector3d::Map(&sockets[0][0])).norm(),
                target.geometry.at("spacing")[0], 1e-9);
  }
  EXPECT_EQ(calibration->check.u, std::vector{0.05});
}

}  // namespace
}  // namespace scancal::flange_ball
