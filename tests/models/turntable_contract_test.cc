// The turntable, with both residuals and for a negative M, passes the contract.
#include "io/units.h"
#include "models/models.h"
#include "models/turntable/verdicts.h"
#include "solver/random.h"
#include "tests/io/temporary_folder.h"
#include "tests/model_contract.h"
#include "tests/models/turntable_scene.h"

namespace scancal {
namespace {

template <Turntable::Residuals kResiduals, int kSignOfM, bool kTilts>
struct TurntableCase {
  static constexpr double kNoise = kResiduals == Turntable::Residuals::kDepth ? 0.05 : 0.045;
  static constexpr double kTruthTolerance = 1e-9;  // mm, rad
  static constexpr const char* kRefusedName = "M";

  static TurntableScene Scene(const ContractOptions& options) {
    TurntableScene scene;
    scene.profiles = 40;
    scene.points = 12;
    scene.sweep = 40 * kDegree;
    scene.system[Turntable::kM] *= kSignOfM;
    scene.system[Turntable::kTiltX] = kTilts ? 0.01 : 0;
    scene.system[Turntable::kTiltY] = kTilts ? -0.02 : 0;
    scene.noise_y = 0.05 * options.noise;
    scene.seed = options.seed;
    return scene;
  }

  static ContractData Make(const ContractOptions& options) {
    TurntableScene scene = Scene(options);
    PoseAsProblem as{kResiduals, options.compressed, options.reversed, 0};
    Turntable model(kResiduals);
    for (const int k : {Turntable::kTiltX, Turntable::kTiltY})
      if (kTilts) model.quantity(k).role = Role::kEstimate;
    Random random(options.seed, 1000);
    if (options.influences) {
      const auto consider = [&](int k, double u) {
        model.quantity(k).role = Role::kConsider;
        model.quantity(k).u = u;
        return u;
      };
      consider(Turntable::kNoiseY, scene.noise_y);
      scene.encoder_jitter = consider(Turntable::kEncoderJitter, 5e-5);
      as.scale_y_error = consider(Turntable::kScaleY, 2e-4) * random.Normal();
      Quantity& n = model.quantity(Turntable::kN);  // a prior, whose mean is drawn too
      n.u = 0.2;
      n.value = scene.system.N() + n.u * random.Normal();
    }
    ContractData data{MakeTurntableProblem(scene, as, model), {}, {}, 0};
    if (options.influences) data.problem.WeighEqually(scene.noise_y);
    data.start = StartNear(data.problem, scene.system);
    data.truth = data.start.system;
    data.truth[0] = scene.system.M();
    data.truth[1] = scene.system.N();
    if (kTilts) data.truth.tail(2) << scene.system[Turntable::kTiltX], scene.system[Turntable::kTiltY];
    data.count = 3.0 * scene.profiles * scene.points;
    return data;
  }

  static Eigen::VectorXd RoundTrip(double noise) {
    const TemporaryFolder folder;
    TurntableScene scene = Scene({noise, 1, true, false, false});
    scene.search = SearchAround(scene.system, 20, 30);
    EXPECT_TRUE(WriteSimulatedTurntable(scene, ScanFileFormat::kNpy, folder.path()).ok());
    if (kTilts) {
      std::string yaml = folder.Read("dataset.yaml");
      folder.Write("dataset.yaml", yaml + "parameters: {tilt_x: estimate, tilt_y: estimate}\n");
    }
    const auto dataset = ReadDataset(folder.path());
    const auto scanner = (*FindScannerKind(*dataset))->load(*dataset);
    const auto result = (*scanner)->Calibrate({kResiduals == Turntable::Residuals::kDepth ? "depth" : "plane"});
    EXPECT_TRUE(result.ok() && result->ok());
    return Eigen::Vector4d(result->Find("M")->value - scene.system.M(), result->Find("N")->value - scene.system.N(),
                           result->Find("tilt_x")->value - scene.system[Turntable::kTiltX],
                           result->Find("tilt_y")->value - scene.system[Turntable::kTiltY]);
  }

  // A plate perpendicular to the axis: every offset fits. (No profiler sees it; a lidar does.)
  static std::string Refusal() {
    ContractData data = Make({});
    std::vector<Turntable::Target> targets(1);
    targets[0].name = "floor";
    Turntable::SetPlane({0, 0, 1}, 100, &targets[0]);
    for (int k = 0; k < 10; ++k)
      targets[0].views.push_back({0.1 * k, {{1, 50, 100}, {1, 80, 100}, {1, 95, 100}}, 3, true});
    TurntableFit fit;
    fit.solution.problem = MakeProblem<Turntable>(std::make_shared<const Turntable>(kResiduals), targets);
    fit.solution.observability = Observe(
        fit.solution.problem, Linearize(fit.solution.problem, NominalStart(fit.solution.problem), Storey::kViews));
    const Result<void> determined = CheckDetermined(fit);
    return determined.ok() ? "" : determined.error().message;
  }
};

using Cases = ::testing::Types<
    TurntableCase<Turntable::Residuals::kDepth, 1, false>, TurntableCase<Turntable::Residuals::kDepth, -1, true>,
    TurntableCase<Turntable::Residuals::kPlane, 1, false>, TurntableCase<Turntable::Residuals::kPlane, -1, true>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Turntable, ModelContract, Cases);

}  // namespace
}  // namespace scancal
