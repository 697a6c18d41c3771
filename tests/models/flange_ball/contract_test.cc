// The ball on a robot's flange passes the contract.
#include <fmt/format.h>
#include <algorithm>
#include "models/flange_ball/scanner.h"
#include "models/models.h"
#include "tests/io/temporary_folder.h"
#include "tests/model_contract.h"
#include "tests/models/flange_ball/scene.h"

namespace scancal::flange_ball {
namespace {

struct FlangeBallCase {
  static constexpr double kNoise = 0.1;
  static constexpr double kTruthTolerance = 1e-8;  // mm, rad
  static constexpr const char* kRefusedName = "theta_1";
  static constexpr double kJointNoise = 1e-4, kSpacingU = 0.05, kPriorU = 0.05;
  static constexpr int kPriorOf = Model::kLinks + kLinkNumbers + 2;  // a_2

  static Model ModelOf(const Scene& scene) {
    Model model(scene.nominal);
    model.quantity(Model::kSpacing).value = SceneChoice().spacing;
    return model;
  }

  static ContractData Make(const ContractOptions& options) {
    SceneChoice choice{.seat = kNoise * options.noise, .seed = options.seed};
    Random random(options.seed, 1000);
    if (options.influences) {
      choice.joints = kJointNoise;
      choice.spacing += kSpacingU * random.Normal();
    }
    Scene scene = MakeScene(choice);
    Model model = ModelOf(scene);
    const Eigen::VectorXd truth = TruthOf(scene, model);
    if (options.influences) {
      const auto consider = [&](int k, double u) {
        model.quantity(k).role = Role::kConsider;
        model.quantity(k).u = u;
      };
      consider(Model::kSpacing, kSpacingU);
      for (int k = 0; k < 3; ++k) consider(Model::kSeat + k, choice.seat);
      for (int k = 0; k < 7; ++k) consider(model.FirstOfJoints() + k, kJointNoise);
      Quantity& prior = model.quantity(kPriorOf);
      prior.u = kPriorU;
      prior.value = scene.truth.links[1].a - scene.nominal[1].a + prior.u * random.Normal();
    }
    if (options.reversed) {
      std::reverse(scene.tools.begin(), scene.tools.end());
      for (Model::Target& tool : scene.tools) std::reverse(tool.views.begin(), tool.views.end());
    }
    ContractData data;
    data.problem = MakeProblem(std::make_shared<const Model>(model), scene.tools);
    if (options.influences) data.problem.WeighEqually(choice.seat);
    data.start = StartNear(scene, data.problem, truth);
    data.truth = truth;
    for (const Model::Target& tool : scene.tools) data.count += 3.0 * static_cast<double>(tool.views.size());
    return data;
  }

  static Estimate StartNear(const Scene& scene, const Problem& problem, const Eigen::VectorXd& truth) {
    Estimate start = NominalStart(problem);
    const std::vector<int> system = problem.With({Scope::kSystem}, Role::kEstimate);
    for (size_t k = 0; k < system.size(); ++k) {
      const auto e = static_cast<Eigen::Index>(k);
      start.system[e] = truth[e] + (problem.quantities[system[k]].unit == Unit::kMm ? 0.2 : 1e-3);
    }
    for (size_t t = 0; t < scene.tools.size(); ++t)
      start.targets[t].head<3>() = scene.truth.Socket(scene.tools[t], 0) + Eigen::Vector3d(0.3, -0.2, 0.1);
    return start;
  }

  static Eigen::VectorXd RoundTrip(double noise) {
    const TemporaryFolder folder;
    const Scene scene = MakeScene({.seat = kNoise * noise});
    std::string yaml = "scancal: 1\nmodel: flange-ball\nunits: {length: mm, angle: rad}\nrobot:\n  links:\n";
    for (const Link& link : scene.nominal)
      yaml += fmt::format("    - {{d: {:.17g}, a: {:.17g}, alpha: {:.17g}}}\n", link.d, link.a, link.alpha);
    yaml += "parameters: {spacing: {consider: 50, u: 0.05}}\ntargets:\n";
    for (const Model::Target& tool : scene.tools) {
      std::string tables[2];
      for (std::string& table : tables) table = "q1,q2,q3,q4,q5,q6,q7\n";
      for (const Model::View& view : tool.views)
        tables[view.socket] += fmt::format("{:.17g}\n", fmt::join(view.joints, ","));
      for (const int s : {0, 1}) folder.Write(fmt::format("{}_{}.csv", tool.name, s), tables[s]);
      yaml += fmt::format("  - {{name: {0}, sockets: [{0}_0.csv, {0}_1.csv]}}\n", tool.name);
    }
    folder.Write("dataset.yaml", yaml);
    const auto dataset = ReadDataset(folder.path());
    const auto scanner = (*FindScannerKind(*dataset))->load(*dataset);
    const auto result = (*scanner)->Calibrate({});
    EXPECT_TRUE(result.ok() && result->ok());
    const Model model = ModelOf(scene);
    Eigen::VectorXd error = -TruthOf(scene, model);
    Eigen::Index e = 0;
    for (const std::string& name : result->estimated) error[e++] += result->Find(name)->value;
    return error;
  }

  // All tools may turn about the first axis together.
  static std::string Refusal() {
    const Scene scene = MakeScene({});
    Model model = ModelOf(scene);
    model.quantity(Model::kLinks).role = Role::kEstimate;
    const Result<Solution> solution = FitJointly(model, scene.tools);
    return solution.ok() ? "" : solution.error().message;
  }
};

INSTANTIATE_TYPED_TEST_SUITE_P(Model, ModelContract, FlangeBallCase);

}  // namespace
}  // namespace scancal::flange_ball
