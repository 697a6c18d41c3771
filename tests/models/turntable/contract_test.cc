// The turntable, with both residuals and for a negative M, passes the contract.
#include "io/units.h"
#include "models/models.h"
#include "models/turntable/scanner.h"
#include "solver/random.h"
#include "tests/io/temporary_folder.h"
#include "tests/model_contract.h"
#include "tests/models/turntable/scene.h"

namespace scancal::turntable {
namespace {

template <Model::Residuals kResiduals, int kSignOfM, bool kTilts>
struct TurntableCase {
  static constexpr double kNoise = kResiduals == Model::Residuals::kDepth ? 0.05 : 0.045;
  static constexpr double kTruthTolerance = 1e-9;  // mm, rad
  static constexpr const char* kRefusedName = "M";

  static Scene SceneOf(const ContractOptions& options) {
    Scene scene;
    scene.profiles = 40;
    scene.points = 12;
    scene.sweep = 40 * kDegree;
    scene.system[Model::kM] *= kSignOfM;
    scene.system[Model::kTiltX] = kTilts ? 0.01 : 0;
    scene.system[Model::kTiltY] = kTilts ? -0.02 : 0;
    scene.noise_y = 0.05 * options.noise;
    scene.seed = options.seed;
    return scene;
  }

  static ContractData Make(const ContractOptions& options) {
    Scene scene = SceneOf(options);
    PoseAsProblem as{kResiduals, options.compressed, options.reversed, 0};
    Model model(kResiduals);
    for (const int k : {Model::kTiltX, Model::kTiltY})
      if (kTilts) model.quantity(k).role = Role::kEstimate;
    Random random(options.seed, 1000);
    if (options.influences) {
      const auto consider = [&](int k, double u) {
        model.quantity(k).role = Role::kConsider;
        model.quantity(k).u = u;
        return u;
      };
      consider(Model::kNoiseY, scene.noise_y);
      scene.encoder_jitter = consider(Model::kEncoderJitter, 5e-5);
      as.scale_y_error = consider(Model::kScaleY, 2e-4) * random.Normal();
      Quantity& n = model.quantity(Model::kN);  // a prior, whose mean is drawn too
      n.u = 0.2;
      n.value = scene.system.N() + n.u * random.Normal();
    }
    ContractData data{MakeProblemOf(scene, as, model), {}, {}, 0};
    if (options.influences) data.problem.WeighEqually(scene.noise_y);
    data.start = StartNear(data.problem, scene.system);
    data.truth = data.start.system;
    data.truth[0] = scene.system.M();
    data.truth[1] = scene.system.N();
    if (kTilts) data.truth.tail(2) << scene.system[Model::kTiltX], scene.system[Model::kTiltY];
    data.count = 3.0 * scene.profiles * scene.points;
    return data;
  }

  static Eigen::VectorXd RoundTrip(double noise) {
    const TemporaryFolder folder;
    Scene scene = SceneOf({noise, 1, true, false, false});
    scene.search = SearchAround(scene.system, 20, 30);
    EXPECT_TRUE(WriteSimulated(scene, ScanFileFormat::kNpy, folder.path()).ok());
    if (kTilts) {
      std::string yaml = folder.Read("dataset.yaml");
      folder.Write("dataset.yaml", yaml + "parameters: {tilt_x: estimate, tilt_y: estimate}\n");
    }
    const auto dataset = ReadDataset(folder.path());
    const auto scanner = (*FindScannerKind(*dataset))->load(*dataset);
    const auto result = (*scanner)->Calibrate({kResiduals == Model::Residuals::kDepth ? "depth" : "plane"});
    EXPECT_TRUE(result.ok() && result->ok());
    return Eigen::Vector4d(result->Find("M")->value - scene.system.M(), result->Find("N")->value - scene.system.N(),
                           result->Find("tilt_x")->value - scene.system[Model::kTiltX],
                           result->Find("tilt_y")->value - scene.system[Model::kTiltY]);
  }

  // A plate perpendicular to the axis: every offset fits. (No profiler sees it; a lidar does.)
  static std::string Refusal() {
    ContractData data = Make({});
    std::vector<Model::Target> targets(1);
    targets[0].name = "floor";
    Model::SetPlane({0, 0, 1}, 100, &targets[0]);
    for (int k = 0; k < 10; ++k)
      targets[0].views.push_back({0.1 * k, {{1, 50, 100}, {1, 80, 100}, {1, 95, 100}}, 3, true});
    JointFit fit;
    fit.solution.problem = MakeProblem<Model>(std::make_shared<const Model>(kResiduals), targets);
    fit.solution.observability = Observe(
        fit.solution.problem, Linearize(fit.solution.problem, NominalStart(fit.solution.problem), Storey::kViews));
    const Result<void> determined = CheckDetermined(fit);
    return determined.ok() ? "" : determined.error().message;
  }
};

using Cases = ::testing::Types<
    TurntableCase<Model::Residuals::kDepth, 1, false>, TurntableCase<Model::Residuals::kDepth, -1, true>,
    TurntableCase<Model::Residuals::kPlane, 1, false>, TurntableCase<Model::Residuals::kPlane, -1, true>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Turntable, ModelContract, Cases);

}  // namespace
}  // namespace scancal::turntable
