// The table of docs/turntable.md, section 6: what may go wrong and what is said.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <optional>
#include "io/units.h"
#include "models/turntable/scanner.h"
#include "solver/random.h"

namespace scancal::turntable {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const System kTruth = {{123, 409}, {}};
const Units kUnits;  // mm, deg

struct PlateAt {
  double turn = 0, lean = 0, distance = 480;  // deg, deg, mm
  Eigen::Vector3d Normal() const {
    const double t = turn * kDegree, l = lean * kDegree;
    return {std::sin(t) * std::cos(l), -std::cos(t) * std::cos(l), std::sin(l)};
  }
};

// White noise of 0.01 mm along depth.
Placement Shown(const PlateAt& plate, double sweep, uint64_t seed) {
  Random random(seed, 0);
  Placement placement;
  placement.name = "plate " + std::to_string(seed);
  placement.largest = 200;
  for (int i = 0; i < 40; ++i) {
    const double alpha = sweep * kDegree * (i / 39.0 - 0.5);
    std::vector<double> y, z;
    for (int j = 0; j < 20; ++j) {
      z.push_back(200 * (j / 19.0 - 0.5));
      const Eigen::Vector3d origin = kTruth.Point(alpha, 0, z.back()),
                            along = kTruth.Point(alpha, 1, z.back()) - origin;
      y.push_back((plate.distance - plate.Normal().dot(origin)) / plate.Normal().dot(along) + 0.01 * random.Normal());
    }
    placement.profiles.push_back(CompressProfile(alpha, y, z, {}));
  }
  return placement;
}

// A plate that lies on the table: every profile sees one height.
Placement Lying(double height, uint64_t seed) {
  Random random(seed, 0);
  Placement placement;
  placement.name = "lying " + std::to_string(seed);
  placement.largest = 200;
  for (int i = 0; i < 40; ++i) {
    std::vector<double> y, z;
    for (int j = 0; j < 20; ++j) {
      y.push_back(50 + 5 * j);
      z.push_back(height + 0.01 * random.Normal());
    }
    placement.profiles.push_back(CompressProfile(i * kDegree, y, z, {}));
  }
  return placement;
}

Scanner ScannerOf(std::vector<Placement> placements, const GridBox& box = {{110, 395}, {130, 425}, 1},
                  const std::function<void(Model*)>& change = {}) {
  Declaration declaration;
  declaration.search = box;
  Model model(Model::Residuals::kDepth);
  if (change) change(&model);
  return {declaration, model, std::move(placements)};
}

std::vector<Placement> See(const std::vector<PlateAt>& plates, double sweep = 30) {
  std::vector<Placement> placements;
  for (const PlateAt& plate : plates) placements.push_back(Shown(plate, sweep, placements.size() + 1));
  return placements;
}

const std::vector<PlateAt> kGood = {{-25, 12}, {0, -8}, {25, 16}};

class VerdictsTest : public ::testing::Test {
 protected:
  static Calibration Calibrated(const Scanner& scanner) {
    const auto calibration = scanner.Calibrate({});
    EXPECT_TRUE(calibration.ok()) << calibration.error().message;
    return calibration.ok() ? *calibration : Calibration();
  }
  static std::string Refusal(const Scanner& scanner) {
    const auto calibration = scanner.Calibrate({});
    EXPECT_FALSE(calibration.ok());
    return calibration.ok() ? "" : calibration.error().message;
  }
  static void ExpectTruth(const Calibration& calibration) {
    ASSERT_TRUE(calibration.Find("M") && calibration.Find("N"));
    EXPECT_NEAR(calibration.Find("M")->value, kTruth.M(), 4 * calibration.Find("M")->u);
    EXPECT_NEAR(calibration.Find("N")->value, kTruth.N(), 4 * calibration.Find("N")->u);
  }
  static std::string Joined(const std::vector<Sentence>& sentences) {
    std::string all;
    for (const std::string& sentence : sentences) all += sentence + "\n";
    return all;
  }
};

TEST_F(VerdictsTest, GoodPlacementsRaiseNoDoubt) {
  const Calibration calibration = Calibrated(ScannerOf(See(kGood)));
  ExpectTruth(calibration);
  EXPECT_THAT(calibration.unreliable, IsEmpty());
  EXPECT_THAT(calibration.warnings, IsEmpty());
}

TEST_F(VerdictsTest, OnePlacement) {
  const Calibration calibration = Calibrated(ScannerOf(See({{0, 10}})));
  ExpectTruth(calibration);
  EXPECT_THAT(Joined(calibration.unreliable),
              AllOf(HasSubstr("only one placement"), HasSubstr("M suffers most"), HasSubstr("add a placement")));
}

TEST_F(VerdictsTest, FiveDegreesApartAreEnough) {
  // The threshold from both sides; a normal may point either way.
  for (const double apart : {4.0, 4.8, 5.2, 6.0}) {
    const Calibration calibration = Calibrated(ScannerOf(See({{0, 0}, {apart, 0, 470}, {apart / 2, 0, 490}})));
    ExpectTruth(calibration);
    EXPECT_EQ(calibration.ok(), apart > 5) << apart << ": " << Joined(calibration.unreliable);
    if (apart > 5) continue;
    EXPECT_THAT(Joined(calibration.unreliable),
                AllOf(HasSubstr("within " + std::string(apart == 4 ? "4 deg" : "4.8 deg")), HasSubstr("suffers most"),
                      HasSubstr("add a placement")));
  }
}

TEST_F(VerdictsTest, LeaningApartCountsAsWell) {
  EXPECT_TRUE(Calibrated(ScannerOf(See({{0, -15}, {0, 15, 470}}))).ok());
}

TEST_F(VerdictsTest, HorizontalPlanes) {
  EXPECT_THAT(
      Refusal(ScannerOf({Lying(20, 1), Lying(-30, 2)})),
      AllOf(HasSubstr("M, N: not determined"), HasSubstr("perpendicular to the axis"), HasSubstr("stand the plate")));
}

TEST_F(VerdictsTest, OneHorizontalPlaneAmongGoodOnes) {
  std::vector<Placement> placements = See(kGood);
  placements.push_back(Lying(20, 9));
  EXPECT_THAT(Refusal(ScannerOf(placements)),
              AllOf(HasSubstr("lying 9"), HasSubstr("edge-on"), HasSubstr("leave it out")));
}

TEST_F(VerdictsTest, HorizontalPlanesNameOnlyWhatIsEstimated) {
  EXPECT_THAT(Refusal(ScannerOf({Lying(20, 1), Lying(-30, 2)}, {{110, 395}, {130, 425}, 1},
                                [](Model* model) {
                                  model->quantity(Model::kM).role = Role::kHold;
                                  model->quantity(Model::kM).value = 123;
                                })),
              ::testing::StartsWith("N: not determined"));
}

TEST_F(VerdictsTest, NoSweep) {
  const auto plausible = CheckPlausible(See(kGood, 0), kUnits);
  ASSERT_FALSE(plausible.ok());
  EXPECT_THAT(plausible.error().message, AllOf(HasSubstr("M, N: not determined"), HasSubstr("must turn")));
}

TEST_F(VerdictsTest, ScalesWithoutAPriorAreFoundOutEvenBehindTheDeclaration) {
  for (const Model::Index scale : {Model::kScaleY, Model::kScaleZ}) {
    const std::string refusal = Refusal(ScannerOf(
        See(kGood), {{110, 395}, {130, 425}, 1}, [&](Model* model) { model->quantity(scale).role = Role::kEstimate; }));
    EXPECT_THAT(refusal, AllOf(HasSubstr(scale == Model::kScaleY ? "scale_y" : "scale_z"), HasSubstr("not determined"),
                               HasSubstr("hold"), HasSubstr("prior")));
  }
}

TEST_F(VerdictsTest, AScaleWithAPriorStaysAtIt) {
  const Calibration calibration = Calibrated(ScannerOf(See(kGood), {{110, 395}, {130, 425}, 1}, [](Model* model) {
    model->quantity(Model::kScaleY).role = Role::kEstimate;
    model->quantity(Model::kScaleY).u = 0.001;
  }));
  const Parameter* scale = calibration.Find("scale_y");
  ASSERT_TRUE(scale);
  EXPECT_NEAR(scale->value, 0, 1e-6);
  EXPECT_NEAR(scale->u, 0.001, 1e-6);
}

TEST_F(VerdictsTest, ANarrowSweepIsHonest) {
  double wide = Calibrated(ScannerOf(See(kGood, 30))).Find("N")->u;
  for (const double sweep : {4.8, 3.0}) {
    const Calibration calibration = Calibrated(ScannerOf(See(kGood, sweep), {{100, 380}, {146, 438}, 1}));
    ExpectTruth(calibration);
    EXPECT_THAT(Joined(calibration.warnings), HasSubstr("too narrow"));
    EXPECT_GT(calibration.Find("N")->u, 10 * wide) << sweep;  // grows with the square of the sweep
  }
  EXPECT_THAT(Joined(Calibrated(ScannerOf(See(kGood, 5.2), {{100, 380}, {146, 438}, 1})).warnings), IsEmpty());
}

TEST_F(VerdictsTest, TheMinimumOnAnyEdge) {
  const GridBox boxes[] = {{{124, 395}, {140, 425}, 1},
                           {{100, 395}, {120, 425}, 1},
                           {{110, 412}, {130, 425}, 1},
                           {{110, 380}, {130, 400}, 1}};
  for (const GridBox& box : boxes) {
    const Calibration calibration = Calibrated(ScannerOf(See(kGood), box));
    ExpectTruth(calibration);
    EXPECT_THAT(Joined(calibration.unreliable), AllOf(HasSubstr("on the edge"), HasSubstr("widen search")));
  }
}

TEST_F(VerdictsTest, AHeldOffsetHasNoEdge) {
  const Calibration calibration = Calibrated(ScannerOf(See(kGood), {{110, 395}, {130, 425}, 1}, [](Model* model) {
    model->quantity(Model::kM).role = Role::kHold;
    model->quantity(Model::kM).value = kTruth.M();
  }));
  EXPECT_TRUE(calibration.ok()) << Joined(calibration.unreliable);
  EXPECT_EQ(calibration.Find("M")->value, kTruth.M());
}

TEST_F(VerdictsTest, UnitsThatCannotBe) {
  std::vector<Placement> placements = See(kGood);
  EXPECT_TRUE(CheckPlausible(placements, kUnits).ok());
  placements[1].largest = 60e3;
  EXPECT_THAT(CheckPlausible(placements, kUnits).error().message,
              AllOf(HasSubstr("plate 2"), HasSubstr("60 m"), HasSubstr("units")));
  for (Placement& placement : placements) placement.largest = 0.2;
  EXPECT_THAT(CheckPlausible(placements, kUnits).error().message, AllOf(HasSubstr("0.2 mm"), HasSubstr("units")));
}

TEST_F(VerdictsTest, AnglesThatCannotBe) {
  EXPECT_TRUE(CheckPlausible(See({{0, 10}}, 1.1), kUnits).ok());
  EXPECT_THAT(CheckPlausible(See({{0, 10}}, 0.5), kUnits).error().message,
              AllOf(HasSubstr("0.5 deg"), HasSubstr("angle: rad")));
  EXPECT_TRUE(CheckPlausible(See({{0, 10}}, 100), kUnits).ok());
  EXPECT_THAT(CheckPlausible(See({{0, 10}}, 1718), kUnits).error().message,
              AllOf(HasSubstr("plate 1"), HasSubstr("1718 deg"), HasSubstr("degrees")));
}

TEST_F(VerdictsTest, OneProfileMakesNoPlane) {
  std::vector<Placement> placements = See(kGood);
  placements[2].profiles.resize(1);
  const auto plausible = CheckPlausible(placements, kUnits);
  const std::string sentence = plausible.ok() ? Refusal(ScannerOf(placements)) : plausible.error().message;
  EXPECT_THAT(sentence, AllOf(HasSubstr("plate 3"), HasSubstr("two angles")));
}

TEST_F(VerdictsTest, TheWrongSenseCannotBeSeen) {  // the mirror image fits equally well, with -M
  std::vector<Placement> placements = See(kGood);
  for (Placement& placement : placements)
    for (Profile& profile : placement.profiles) profile.alpha = -profile.alpha;
  const Calibration mirrored = Calibrated(ScannerOf(placements, {{-130, 395}, {-110, 425}, 1}));
  const Calibration right = Calibrated(ScannerOf(See(kGood)));
  EXPECT_TRUE(mirrored.ok());
  EXPECT_NEAR(mirrored.Find("M")->value, -right.Find("M")->value, 1e-6);
  EXPECT_NEAR(mirrored.Find("N")->value, right.Find("N")->value, 1e-6);
  EXPECT_NEAR(mirrored.sigma, right.sigma, 1e-9);
}

}  // namespace
}  // namespace scancal::turntable
