// What a turntable's dataset.yaml may say, and what it is told if it says something else.
#include "models/turntable/declare.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include "io/units.h"
#include "tests/io/temporary_folder.h"

namespace scancal::turntable {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr char kTop[] = "scancal: 1\nmodel: turntable\nunits: {length: mm, angle: deg}\n";
constexpr char kRotation[] = "rotation: clockwise\n";
constexpr char kSearch[] = "search: {M: [110, 130], N: [395, 425], step: 1}\n";
constexpr char kTargets[] = "targets: [{name: left, scan: left.csv}]\n";

class DeclarationTest : public ::testing::Test {
 protected:
  Result<Declaration> Declare(const std::string& yaml) {
    folder_.Write("dataset.yaml", yaml);
    SCANCAL_ASSIGN_OR_RETURN(const Dataset dataset, ReadDataset(folder_.path()));
    model_ = Model(Model::Residuals::kDepth);
    return turntable::Declare(dataset, &model_);
  }
  // A sound data set, with these lines in addition.
  Result<Declaration> DeclareWith(const std::string& lines) {
    return Declare(std::string(kTop) + kRotation + kSearch + kTargets + lines);
  }
  std::string ErrorOf(const std::string& yaml) {
    const auto declaration = Declare(yaml);
    return declaration.ok() ? "" : declaration.error().message;
  }
  std::string ErrorWith(const std::string& lines) {
    return ErrorOf(std::string(kTop) + kRotation + kSearch + kTargets + lines);
  }
  std::string ErrorOfSearch(const std::string& search) {
    return ErrorOf(std::string(kTop) + kRotation + "search: " + search + "\n" + kTargets);
  }
  std::string ErrorOfTargets(const std::string& targets) {
    return ErrorOf(std::string(kTop) + kRotation + kSearch + "targets: " + targets + "\n");
  }
  const Quantity& Of(Model::Index index) const { return model_.quantities()[index]; }

  TemporaryFolder folder_;
  Model model_{Model::Residuals::kDepth};
};

TEST_F(DeclarationTest, TheShortestDataSet) {
  const auto declaration = DeclareWith("");
  ASSERT_TRUE(declaration.ok()) << declaration.error().message;
  EXPECT_EQ(declaration->senses.angle, 1);
  EXPECT_THAT(declaration->search.lower, ElementsAre(110, 395));
  EXPECT_THAT(declaration->search.upper, ElementsAre(130, 425));
  EXPECT_EQ(declaration->search.step, 1);
  ASSERT_EQ(declaration->scans.size(), 1U);
  EXPECT_EQ(declaration->scans[0].name, "left");
  EXPECT_EQ(declaration->scans[0].format.path, folder_.path() / "left.csv");
  EXPECT_THAT(declaration->warnings, IsEmpty());
  EXPECT_EQ(Of(Model::kM).role, Role::kEstimate);
  EXPECT_EQ(Of(Model::kN).role, Role::kEstimate);
  EXPECT_EQ(Of(Model::kTiltX).role, Role::kHold);
}

TEST_F(DeclarationTest, UnitsApplyToEveryNumber) {
  const auto declaration = Declare(
      "scancal: 1\nmodel: turntable\nunits: {length: m, angle: deg}\nrotation: counterclockwise\n"
      "search: {M: [0.11, 0.13], N: [-0.4, 0.4], step: 0.001}\n"
      "parameters: {M: {estimate: 0.12, u: 0.001}, tilt_x: {consider: 1, u: 0.5}, scale_y: {consider: 0, u: 1e-4}}\n"
      "influences: {noise_y: 5e-5, encoder_jitter: 0.01}\n"
      "targets: [{name: a, scan: a.csv, keep: {angle: [-10, 20], z: [-0.1, 0.2], speed: [1, 2], lines: [5, 9]}}]\n");
  ASSERT_TRUE(declaration.ok()) << declaration.error().message;
  EXPECT_EQ(declaration->senses.angle, -1);
  EXPECT_NEAR(declaration->search.lower[0], 110, 1e-9);
  EXPECT_NEAR(declaration->search.upper[1], 400, 1e-9);
  EXPECT_NEAR(declaration->search.step, 1, 1e-12);
  EXPECT_NEAR(Of(Model::kM).value, 120, 1e-9);
  EXPECT_NEAR(Of(Model::kM).u, 1, 1e-12);
  EXPECT_NEAR(Of(Model::kTiltX).value, kDegree, 1e-15);
  EXPECT_NEAR(Of(Model::kTiltX).u, 0.5 * kDegree, 1e-15);
  EXPECT_EQ(Of(Model::kScaleY).u, 1e-4);
  EXPECT_NEAR(Of(Model::kNoiseY).u, 0.05, 1e-12);
  EXPECT_EQ(Of(Model::kNoiseY).role, Role::kConsider);
  EXPECT_NEAR(Of(Model::kEncoderJitter).u, 0.01 * kDegree, 1e-15);
  const auto& keep = declaration->scans[0].keep;
  ASSERT_EQ(keep.size(), 3U);
  EXPECT_NEAR(keep[0].upper, 20 * kDegree, 1e-15);
  EXPECT_NEAR(keep[1].lower, -100, 1e-9);
  EXPECT_EQ(keep[2].column, "speed");  // of no known dimension: as in the file
  EXPECT_EQ(keep[2].upper, 2);
  EXPECT_EQ(declaration->scans[0].format.lines, std::pair(int64_t{5}, int64_t{9}));
}

TEST_F(DeclarationTest, ATargetsOwnLayoutWins) {
  const auto declaration = Declare(std::string(kTop) + kRotation + kSearch +
                                   "layout: {wide: y, start: -100, step: 1}\ninvalid: -1\n"
                                   "targets:\n  - {name: a, scan: a.csv}\n"
                                   "  - {name: b, scan: b.csv, invalid: 0, layout: {wide: range, angle_column: 2, "
                                   "first_column: 3, start: -30, step: 0.5}}\n"
                                   "  - {name: c, scan: c.npy, columns: [z, angle, y]}\n");
  ASSERT_TRUE(declaration.ok()) << declaration.error().message;
  const auto& a = declaration->scans[0].format;
  EXPECT_EQ(a.layout->across, "z");
  EXPECT_EQ(a.layout->angle_column, 1);
  EXPECT_EQ(a.layout->first_column, 2);
  EXPECT_EQ(a.invalid, -1);
  const auto& b = declaration->scans[1].format;
  EXPECT_EQ(b.layout->across, "bearing");
  EXPECT_EQ(b.layout->angle_column, 2);
  EXPECT_EQ(b.layout->step, 0.5);
  EXPECT_EQ(b.invalid, 0);
  EXPECT_THAT(declaration->scans[2].format.npy_columns, ElementsAre("z", "angle", "y"));
}

TEST_F(DeclarationTest, RotationIsRequired) {
  EXPECT_THAT(ErrorOf(std::string(kTop) + kSearch + kTargets), HasSubstr("the key 'rotation' is missing"));
  EXPECT_THAT(ErrorOf(std::string(kTop) + "rotation: left\n" + kSearch + kTargets),
              AllOf(HasSubstr("dataset.yaml:4:11: rotation: found \"left\", expected clockwise or counterclockwise")));
}

TEST_F(DeclarationTest, TheSearchIsRequiredAndComplete) {
  EXPECT_THAT(ErrorOf(std::string(kTop) + kRotation + kTargets), HasSubstr("the key 'search' is missing"));
  EXPECT_THAT(ErrorOfSearch("{M: [110, 130], step: 1}"), HasSubstr("the key 'N' is missing"));
  EXPECT_THAT(ErrorOfSearch("{M: [110, 130], N: [395, 425]}"), HasSubstr("the key 'step' is missing"));
  EXPECT_THAT(ErrorOfSearch("{M: [110], N: [395, 425], step: 1}"), HasSubstr(":5:13: search: M: found"));
  EXPECT_THAT(ErrorOfSearch("{M: 110, N: [395, 425], step: 1}"), HasSubstr("search: M: found \"110\", expected"));
  EXPECT_THAT(ErrorOfSearch("{M: [110, 130], N: [395, 425], step: 1, stop: 2}"), HasSubstr("unknown key 'stop'"));
}

TEST_F(DeclarationTest, TheSearchIsABoxWithAStep) {
  EXPECT_THAT(ErrorOfSearch("{M: [130, 110], N: [395, 425], step: 1}"), HasSubstr("M: found [130, 110], expected"));
  EXPECT_THAT(ErrorOfSearch("{M: [110, 110], N: [395, 425], step: 1}"), HasSubstr("M: found [110, 110], expected"));
  EXPECT_THAT(ErrorOfSearch("{M: [110, .inf], N: [395, 425], step: 1}"), HasSubstr("search: M: "));
  EXPECT_THAT(ErrorOfSearch("{M: [110, 130], N: [395, 425], step: 0}"),
              HasSubstr("step: found \"0\", expected a step greater than zero"));
  EXPECT_THAT(ErrorOfSearch("{M: [110, 130], N: [395, 425], step: -1}"), HasSubstr("step: found \"-1\", expected"));
  EXPECT_THAT(ErrorOfSearch("{M: [110, 130], N: [395, 425], step: x}"), HasSubstr("step: found \"x\", expected"));
}

TEST_F(DeclarationTest, ImpossibleSearchesAreTold) {
  EXPECT_THAT(ErrorOfSearch("{M: [110000, 130000], N: [395, 425], step: 1}"),
              AllOf(HasSubstr(":5:13: search: M: "), HasSubstr("130 m"), HasSubstr("units: length")));
  EXPECT_THAT(ErrorOfSearch("{M: [0, 1000], N: [0, 1000], step: 0.001}"),
              AllOf(HasSubstr("1e+12 nodes"), HasSubstr("use a larger step")));
}

TEST_F(DeclarationTest, TargetsAreRequired) {
  EXPECT_THAT(ErrorOf(std::string(kTop) + kRotation + kSearch), HasSubstr("the key 'targets' is missing"));
  EXPECT_THAT(ErrorOfTargets("[]"), HasSubstr("targets: "));
  EXPECT_THAT(ErrorOfTargets("left.csv"), HasSubstr("targets: found \"left.csv\", expected"));
  EXPECT_THAT(ErrorOfTargets("[left.csv]"), HasSubstr("dataset.yaml:6:"));
}

TEST_F(DeclarationTest, TargetsHaveANameAndAScan) {
  EXPECT_THAT(ErrorOfTargets("[{scan: a.csv}]"), HasSubstr("targets: item 1: the key 'name' is missing"));
  EXPECT_THAT(ErrorOfTargets("[{name: a}]"), HasSubstr("targets: item 1: the key 'scan' is missing"));
  EXPECT_THAT(ErrorOfTargets("[{name: '', scan: a.csv}]"), HasSubstr("item 1: name: found \"\", expected a name"));
  EXPECT_THAT(ErrorOfTargets("[{name: a, scan: ''}]"), HasSubstr("item 1: scan: found \"\", expected the path"));
  EXPECT_THAT(ErrorOfTargets("[{name: a, scan: a.csv}, {name: a, scan: b.csv}]"),
              AllOf(HasSubstr("item 2: name: found \"a\""), EndsWith("no other target has")));
  EXPECT_THAT(ErrorOfTargets("[{name: a, scan: a.csv, colour: red}]"), HasSubstr("unknown key 'colour'"));
}

TEST_F(DeclarationTest, KeepIsMadeOfIntervals) {
  EXPECT_THAT(ErrorOfTargets("[{name: a, scan: a.csv, keep: {z: [5, 1]}}]"),
              HasSubstr("keep: z: found [5, 1], expected"));
  EXPECT_THAT(ErrorOfTargets("[{name: a, scan: a.csv, keep: {z: 5}}]"), HasSubstr("keep: z: found \"5\", expected"));
  EXPECT_THAT(ErrorOfTargets("[{name: a, scan: a.csv, keep: [1, 5]}]"), HasSubstr("keep: found a list, expected"));
  EXPECT_THAT(ErrorOfTargets("[{name: a, scan: a.csv, keep: {lines: [0, 5]}}]"), HasSubstr("the first line is 1"));
}

TEST_F(DeclarationTest, LayoutsAreChecked) {
  EXPECT_THAT(ErrorWith("layout: {wide: z, start: 0, step: 1}\n"),
              HasSubstr("layout: wide: found \"z\", expected y or range"));
  EXPECT_THAT(ErrorWith("layout: {wide: y, start: 0, step: 0}\n"), HasSubstr("step: found \"0\", expected"));
  EXPECT_THAT(ErrorWith("layout: {wide: y, step: 1}\n"), HasSubstr("the key 'start' is missing"));
  EXPECT_THAT(ErrorWith("layout: {wide: y, start: 0, step: 1, angle_column: 0}\n"), HasSubstr("1 or more"));
  EXPECT_THAT(ErrorWith("layout: {wide: y, start: 0, step: 1, first_column: -2}\n"), HasSubstr("1 or more"));
}

TEST_F(DeclarationTest, ColumnNumbersAreWhole) {
  EXPECT_THAT(ErrorWith("layout: {wide: y, start: 0, step: 1, angle_column: 1.5}\n"), HasSubstr("angle_column: found"));
  EXPECT_THAT(ErrorWith("layout: {wide: y, start: 0, step: 1, first_column: 1e300}\n"),
              HasSubstr("first_column: found"));
  EXPECT_THAT(ErrorOfTargets("[{name: a, scan: a.csv, keep: {lines: [1.5, 1e300]}}]"), HasSubstr("keep: lines: found"));
}

TEST_F(DeclarationTest, UnknownKeysAreRefused) {
  EXPECT_THAT(ErrorWith("serch: 1\n"), EndsWith("dataset.yaml:7:1: unknown key 'serch', did you mean 'search'?"));
}

TEST_F(DeclarationTest, GaugesAreNoParameters) {
  for (const std::string name : {"yaw", "shift_z"})
    EXPECT_THAT(ErrorWith("parameters: {" + name + ": estimate}\n"),
                AllOf(HasSubstr("parameters: " + name + ": not determined by planes"), HasSubstr("remove it")));
}

TEST_F(DeclarationTest, ScalesNeedAPrior) {
  for (const std::string name : {"scale_y", "scale_z"}) {
    EXPECT_THAT(ErrorWith("parameters: {" + name + ": estimate}\n"),
                AllOf(HasSubstr("parameters: " + name + ": not determined by planes"), HasSubstr("give a prior")));
    EXPECT_THAT(ErrorWith("parameters: {" + name + ": {estimate: 0}}\n"), HasSubstr("give a prior"));
    EXPECT_EQ(ErrorWith("parameters: {" + name + ": {estimate: 0, u: 0.001}}\n"), "");
    EXPECT_EQ(ErrorWith("parameters: {" + name + ": {consider: 0, u: 0.001}}\n"), "");
    EXPECT_EQ(ErrorWith("parameters: {" + name + ": {hold: 0.001}}\n"), "");
  }
}

TEST_F(DeclarationTest, UnknownParametersAreRefused) {
  EXPECT_THAT(ErrorWith("parameters: {tilt_z: estimate}\n"),
              HasSubstr("tilt_z: unknown parameter, did you mean 'tilt_"));
  // Of a target or a point, hence no parameter of the system.
  EXPECT_THAT(ErrorWith("parameters: {normal_1: estimate}\n"), HasSubstr("normal_1: unknown parameter"));
  EXPECT_THAT(ErrorWith("parameters: {noise_y: estimate}\n"), HasSubstr("noise_y: unknown parameter"));
}

TEST_F(DeclarationTest, OffsetsThatAreNotEstimatedNeedAValue) {
  EXPECT_THAT(ErrorWith("parameters: {M: hold}\n"), HasSubstr("parameters: M: hold: expected its value"));
  EXPECT_EQ(ErrorWith("parameters: {M: {hold: 0}}\n"), "");
}

TEST_F(DeclarationTest, InfluencesAreKnownOrRefused) {
  EXPECT_THAT(ErrorWith("influences: {nois_y: 0.1}\n"), HasSubstr("influences: nois_y: unknown influence"));
  EXPECT_THAT(ErrorWith("influences: {M: 0.1}\n"), HasSubstr("influences: M: unknown influence"));
  EXPECT_THAT(ErrorWith("influences: {scale_y: estimate}\n"), HasSubstr("scale_y: not determined by planes"));
  EXPECT_THAT(ErrorWith("parameters: {scale_y: {consider: 0, u: 1e-4}}\ninfluences: {scale_y: 1e-4}\n"),
              HasSubstr("scale_y: declared twice"));
  EXPECT_EQ(ErrorWith("influences: {noise_y: estimate, encoder_jitter: estimate, scale_z: 0}\n"), "");
}

TEST_F(DeclarationTest, EveryInfluenceIsAccepted) {
  const auto declaration = DeclareWith(
      "influences: {noise_y: 0.05, noise_z: 0.01, line_correlation: 40, encoder_jitter: 0.003, encoder_cos1: 0.001, "
      "encoder_sin1: 0.001, encoder_cos2: 0.001, encoder_sin2: 0.001, scale_y: 1e-4, scale_z: 1e-4, shear: 0.01, "
      "linearity: 0.01, flatness: 0.02, one_plate: yes, temperature: 1, expansion: 2.3e-5, linearity_3: 0.01, "
      "lens_z2: 0.01, lens_yz: 0.01, lens_yz2: 0.01, range_offset: 0.1, range_scale: 1e-4, encoder_scale: 1e-5, "
      "backlash: 0.01, latency: 0.001, runout: 0.002, wobble: 0.001, drift_sweep: 0.05, drift: 0.1, warm_up: 0.1, "
      "drift_temperature: 0.05}\n");
  ASSERT_TRUE(declaration.ok()) << declaration.error().message;
  EXPECT_THAT(declaration->warnings, IsEmpty());
  EXPECT_THAT(declaration->notes, IsEmpty());
  EXPECT_EQ(declaration->line_correlation, 40);
  for (int k = 0; k < Model::kRunOuts; ++k) {
    EXPECT_EQ(model_.quantity(Model::kRunOut + k).role, Role::kConsider);
    EXPECT_NEAR(model_.quantity(Model::kRunOut + k).u, 0.002, 1e-15);
    EXPECT_NEAR(model_.quantity(Model::kWobble + k).u, 0.001 * kDegree, 1e-15);
  }
  EXPECT_EQ(Of(Model::kForm).scope, Scope::kSystem);
  EXPECT_NEAR(Of(Model::kForm).u, 0.02 / 3.354, 1e-12);  // a bow
}

TEST_F(DeclarationTest, WhetherItIsOnePlateIsAskedFor) {
  const auto declaration = DeclareWith("influences: {flatness: 0.02}\n");
  ASSERT_EQ(declaration->notes.size(), 1U);
  EXPECT_THAT(declaration->notes[0].english, HasSubstr("Declare one_plate: yes or no"));
  EXPECT_TRUE(Of(Model::kForm).perhaps_shared);
  EXPECT_EQ(Of(Model::kForm).scope, Scope::kTarget);
}

TEST_F(DeclarationTest, ADriftThatIsHeldIsNotEstimated) {
  EXPECT_TRUE(DeclareWith("influences: {drift_sweep: hold}\n")->drift_held);
  EXPECT_FALSE(DeclareWith("")->drift_held);
}

TEST_F(DeclarationTest, WhatSweepsTellNeedsNoPrior) {
  EXPECT_TRUE(DeclareWith("influences: {drift_sweep: estimate, encoder_scale: estimate, lens_yz2: estimate}\n").ok());
  EXPECT_THAT(ErrorWith("influences: {range_scale: estimate}\n"), HasSubstr("not determined by planes"));
  EXPECT_THAT(ErrorWith("influences: {runout: estimate}\n"), HasSubstr("not determined by planes"));
}

TEST_F(DeclarationTest, InfluencesThatCannotBe) {
  EXPECT_THAT(ErrorWith("influences: {form: 0.005, flatness: 0.02}\n"), HasSubstr("form or flatness, not both"));
  EXPECT_THAT(ErrorWith("influences: {form: estimate}\n"), HasSubstr("form: expected its size"));
  EXPECT_THAT(ErrorWith("influences: {one_plate: 3}\n"), HasSubstr("one_plate: expected yes or no"));
  EXPECT_THAT(ErrorWith("influences: {noise_y: yes}\n"), HasSubstr("noise_y: found yes, expected a standard"));
  EXPECT_THAT(ErrorWith("influences: {noise_y: 0}\n"), HasSubstr("noise_y: expected more than 0"));
  EXPECT_THAT(ErrorWith("influences: {noise_z: estimate}\n"), HasSubstr("cannot tell it from noise_y"));
  EXPECT_THAT(ErrorWith("influences: {line_correlation: 0.5}\n"), HasSubstr("in points, 1 is white noise"));
  EXPECT_THAT(ErrorWith("influences: {temperature: 2}\n"), HasSubstr("temperature (K) and expansion (1/K) together"));
}

TEST_F(DeclarationTest, TheSamePointsTwice) {
  EXPECT_THAT(ErrorOfTargets("[{name: a, scan: left.csv}, {name: b, scan: ./left.csv}]"),
              HasSubstr("other points than those of target a"));
  EXPECT_EQ(ErrorOfTargets("[{name: a, scan: left.csv, keep: {lines: [1, 9]}}, "
                           "{name: b, scan: left.csv, keep: {lines: [10, 20]}}]"),
            "");
}

}  // namespace
}  // namespace scancal::turntable
