// Roles of the parameters: estimate, with a prior, consider, hold; and the residuals.
#include <gmock/gmock.h>
#include <map>
#include "io/units.h"
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class RolesTest : public CliTest {
 protected:
  // Refines the data with this line in dataset.yaml; the old file is back afterwards.
  Json With(const std::string& line, int exit_code = 0, const std::vector<std::string>& flags = {}) const {
    const std::string old = ReadWhole(data_ / "dataset.yaml");
    Append(data_ / "dataset.yaml", line + "\n");
    Json result = Refined(data_, exit_code, flags);
    WriteWhole(data_ / "dataset.yaml", old);
    return result;
  }
  std::string Refusal(const std::string& line) const {
    const std::string old = ReadWhole(data_ / "dataset.yaml");
    Append(data_ / "dataset.yaml", line + "\n");
    const Outcome outcome = Refine(data_);
    WriteWhole(data_ / "dataset.yaml", old);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
    return OneSentence(outcome);
  }

  const fs::path data_ = MakeData();
};

TEST_F(RolesTest, WithoutASectionMAndNAreEstimated) {
  const Json result = Refined(data_);
  for (const char* name : {"M", "N"}) EXPECT_EQ(ParameterOf(result, name)["role"], "estimate");
  for (const char* name : {"tilt_x", "tilt_y", "scale_y", "scale_z"}) {
    EXPECT_EQ(ParameterOf(result, name)["role"], "hold") << name;
    EXPECT_EQ(ValueOf(result, name), 0) << name;
    EXPECT_EQ(UOf(result, name), 0) << name;
  }
}

TEST_F(RolesTest, AHeldParameterKeepsItsValue) {
  const Json result = With("parameters: {M: {hold: 123}}");
  EXPECT_EQ(ParameterOf(result, "M")["role"], "hold");
  EXPECT_EQ(ValueOf(result, "M"), 123);
  EXPECT_EQ(UOf(result, "M"), 0);
  EXPECT_EQ(ParameterOf(result, "N")["role"], "estimate");
  EXPECT_NEAR(ValueOf(result, "N"), 409, 4 * UOf(result, "N"));
  EXPECT_LE(UOf(result, "N"), UOf(Refined(data_), "N") * 1.01);
  EXPECT_EQ(result["covariance"].size(), 1U);
  EXPECT_EQ(result["covariance_of"], Json({"N"}));
  EXPECT_EQ(result["grid"]["M"], 123);
}

TEST_F(RolesTest, AWrongHeldValueIsNotQuietlyBelieved) {
  const Json result = With("parameters: {M: {hold: 126}}", 2);  // what it leaves is shared by neighbours
  EXPECT_EQ(ValueOf(result, "M"), 126);
  EXPECT_THAT(Sentences(result, "warnings"), HasSubstr("lack of fit: M is held, but the residuals ask for -"));
  EXPECT_THAT(result["messages"].dump(), HasSubstr("Mangelnde Anpassung: M ist festgehalten, die Residuen verlangen"));
}

TEST_F(RolesTest, BothMayBeHeld) {
  const Json result = With("parameters: {M: {hold: 123}, N: {hold: 409}}");
  EXPECT_EQ(ValueOf(result, "M"), 123);
  EXPECT_EQ(ValueOf(result, "N"), 409);
  EXPECT_EQ(result["covariance"].size(), 0U);
}

TEST_F(RolesTest, TiltsAreEstimatedOnRequest) {
  const Json result = With("parameters: {tilt_x: estimate, tilt_y: estimate}");
  for (const char* name : {"tilt_x", "tilt_y"}) {
    EXPECT_EQ(ParameterOf(result, name)["role"], "estimate");
    EXPECT_EQ(ParameterOf(result, name)["unit"], "rad");
    EXPECT_NEAR(ValueOf(result, name), 0, 4 * UOf(result, name));
    EXPECT_GT(UOf(result, name), 1e-6);
    EXPECT_LT(UOf(result, name), 2e-3);
  }
  EXPECT_EQ(result["covariance"].size(), 4U);
}

TEST_F(RolesTest, AConsideredTiltEnlargesU) {
  // Equal weights: what is considered changes the estimated ones a little.
  const Json held = Refined(data_, 0, {"--weights=equal"}),
             considered = With("parameters: {tilt_y: {consider: 0, u: 0.05}}", 0, {"--weights=equal"});
  EXPECT_EQ(ParameterOf(considered, "tilt_y")["role"], "consider");
  EXPECT_NEAR(UOf(considered, "tilt_y"), 0.05 * kDegree, 1e-12);
  double enlarged = 0;
  for (const char* name : {"M", "N"}) {
    EXPECT_NEAR(ValueOf(considered, name), ValueOf(held, name), 1e-9);
    const double more = std::pow(UOf(considered, name), 2) - std::pow(UOf(held, name), 2);
    EXPECT_GE(more, -1e-12);
    enlarged = std::max(enlarged, more / std::pow(UOf(held, name), 2));
    // The budget has its line, and explains the enlargement.
    bool found = false;
    for (const Json& line : considered["budget"]) {
      if (line["source"] != "tilt_y") continue;
      found = true;
      EXPECT_NEAR(line["value"], 0.05 * kDegree, 1e-12);
      EXPECT_NEAR(line["u"][name], std::sqrt(std::max(0.0, more)), 1e-3 * UOf(held, name));
      EXPECT_NEAR(std::abs(line["sensitivity"][name].get<double>()) * 0.05 * kDegree, line["u"][name], 1e-9);
    }
    EXPECT_TRUE(found);
  }
  EXPECT_GT(enlarged, 0.1);
}

TEST_F(RolesTest, TheSensitivityToATiltIsWhatHoldingItElsewhereDoes) {
  const auto equal = [&](const std::string& line) { return With(line, 0, {"--weights=equal"}); };
  const Json considered = equal("parameters: {tilt_y: {consider: 0, u: 0.05}}"),
             moved = equal("parameters: {tilt_y: {hold: 0.05}}"), back = equal("parameters: {tilt_y: {hold: -0.05}}");
  for (const Json& line : considered["budget"]) {
    if (line["source"] != "tilt_y") continue;
    for (const char* name : {"M", "N"})
      EXPECT_NEAR((ValueOf(moved, name) - ValueOf(back, name)) / (0.1 * kDegree), line["sensitivity"][name],
                  0.02 * std::abs(line["sensitivity"][name].get<double>()) + 0.5)
          << name;
  }
}

TEST_F(RolesTest, APriorPullsAndSharpens) {
  const Json free = Refined(data_), prior = With("parameters: {N: {estimate: 409.2, u: 0.01}}");
  EXPECT_NEAR(ValueOf(prior, "N"), 409.2, 0.01);
  EXPECT_LT(UOf(prior, "N"), 0.0101);
  const double u_data = UOf(free, "N"), u_prior = 0.1;
  const Json weak = With("parameters: {N: {estimate: 409.2, u: 0.1}}");
  const double w = 1 / (u_data * u_data), w_prior = 1 / (u_prior * u_prior);
  const double expected = (w * ValueOf(free, "N") + w_prior * 409.2) / (w + w_prior);
  EXPECT_NEAR(ValueOf(weak, "N"), expected, 0.03);
  EXPECT_NEAR(UOf(weak, "N"), 1 / std::sqrt(w + w_prior), 0.02);
}

TEST_F(RolesTest, NumbersAreInTheDeclaredUnits) {
  const Json degrees = With("parameters: {tilt_x: {hold: 0.002}}");
  EXPECT_NEAR(ValueOf(degrees, "tilt_x"), 0.002 * kDegree, 1e-15);
}

TEST_F(RolesTest, AHeldOffsetNeedsItsValue) {
  EXPECT_THAT(Refusal("parameters: {M: hold}"), AllOf(StartsWith((data_ / "dataset.yaml").string()),
                                                      HasSubstr("parameters: M: "), HasSubstr("{hold: 123}")));
}

TEST_F(RolesTest, AnUnknownParameterIsRefused) {
  EXPECT_THAT(Refusal("parameters: {tiltx: estimate}"),
              AllOf(HasSubstr("tiltx: unknown parameter"), HasSubstr("did you mean 'tilt_x'?")));
}

TEST_F(RolesTest, DeclaredInfluencesMakeTheBudgetAndTheFootnote) {
  EXPECT_THAT(Refine(data_).out, HasSubstr("not a traceable uncertainty"));
  const Json held = Refined(data_), scaled = With("influences: {scale_y: 0.001}");
  EXPECT_NEAR(std::pow(UOf(scaled, "N"), 2) - std::pow(UOf(held, "N"), 2), std::pow(0.409, 2), 0.02 * 0.409);
  Append(data_ / "dataset.yaml", "influences: {scale_y: 0.001}\n");
  EXPECT_THAT(Refine(data_).out, Not(HasSubstr("not a traceable uncertainty")));
}

TEST_F(RolesTest, DeclaredNoiseAloneIsNotTraceable) {
  Append(data_ / "dataset.yaml", "influences: {noise_y: 0.05, line_correlation: 1}\n");
  EXPECT_THAT(Refine(data_).out, HasSubstr("not a traceable uncertainty"));
}

TEST_F(RolesTest, NoNoiseIsADeclarationThatResidualsMayContradict) {
  Simulate(Path("noisy"), {"--profiles=60", "--points=60", "--encoder_jitter=0.01", "--line_correlation=10"});
  Append(Path("noisy") / "dataset.yaml", "influences: {encoder_jitter: 0, line_correlation: 1}\n");
  EXPECT_THAT(Sentences(Refined(Path("noisy"), 2), "unreliable"),
              AllOf(HasSubstr("encoder_jitter: declared with u = 0, but the residuals show"),
                    HasSubstr("line_correlation (offset): declared with u = 0, but the residuals show")));
  EXPECT_EQ(Sentences(With("influences: {encoder_jitter: 0, line_correlation: 1}"), "warnings"), "");
}

TEST_F(RolesTest, WhatWasSimulatedIsDeclared) {
  Simulate(Path("declared"),
           {"--profiles=20", "--points=20", "--form=0.005", "--one_plate", "--line_correlation=5", "--declare"});
  EXPECT_THAT(ReadWhole(Path("declared") / "dataset.yaml"),
              HasSubstr("influences: {noise_y: 0.05, form: 0.005, line_correlation: 5, one_plate: yes}"));
}

TEST_F(RolesTest, WhatIsConsideredIsNoCorrelationOfNeighbours) {
  Simulate(Path("tilted"), {"--tilt_x=0.5", "--noise=0.01"});
  Append(Path("tilted") / "dataset.yaml", "parameters: {tilt_x: {consider: 0, u: 0.5}}\n");
  const Json result = Refined(Path("tilted"));
  EXPECT_GT(result["neighbours"].get<double>(), 0.2);
  EXPECT_THAT(Sentences(result, "warnings"), Not(HasSubstr("neighbouring views")));
}

TEST_F(RolesTest, APriorOfWhatPlanesDoNotSeeLeavesNumbers) {
  const Json result = With("influences: {scale_y: {estimate: 0, u: 1e-4}}");
  EXPECT_NEAR(UOf(result, "scale_y"), 1e-4, 1e-9);
  for (const Json& line : result["budget"]) EXPECT_TRUE(line["share"]["scale_y"].is_number()) << line;
}

TEST_F(RolesTest, EveryInfluenceHasItsLineOfTheBudget) {
  const Json result = With(
      "influences: {noise_y: 0.1, noise_z: 0.1, line_correlation: 3, encoder_jitter: 0.01, encoder_cos1: 0.002, "
      "encoder_sin1: 0.002, encoder_cos2: 0.002, encoder_sin2: 0.002, scale_y: 1e-4, scale_z: 1e-4, shear: 0.01, "
      "linearity: 0.01, flatness: 0.06, temperature: 2, expansion: 12e-6, linearity_3: 0.01, lens_z2: 0.01, "
      "lens_yz: 0.01, lens_yz2: 0.01, encoder_scale: 1e-5, runout: 0.002, wobble: 0.001, drift_sweep: 0.05, drift: "
      "0.1, "
      "warm_up: 0.1}");
  std::map<std::string, double> of_N;
  for (const Json& line : result["budget"]) of_N[line["source"]] = line["u"]["N"];
  for (const char* source : {"noise_y",
                             "noise_z",
                             "line_correlation (offset)",
                             "line_correlation (slope)",
                             "encoder_jitter",
                             "encoder_cos1",
                             "encoder_sin1",
                             "encoder_cos2",
                             "encoder_sin2",
                             "scale_y",
                             "scale_z",
                             "shear",
                             "linearity",
                             "form",
                             "expansion",
                             "linearity_3",
                             "lens_z2",
                             "lens_yz",
                             "lens_yz2",
                             "encoder_scale",
                             "runout",
                             "wobble",
                             "drift_sweep",
                             "drift",
                             "warm_up"})
    EXPECT_TRUE(of_N.contains(source)) << source;
  EXPECT_NEAR(of_N["expansion"], 409 * 2 * 12e-6, 1e-4);  // the mount grows
  EXPECT_NEAR(of_N["scale_y"], 409 * 1e-4, 1e-3);
  EXPECT_NEAR(With("influences: {form: 0.01}")["budget"].back()["value"], 0.06 / 6, 1e-12);
  double sum = 0;
  for (const auto& [source, u] : of_N) sum += u * u;
  EXPECT_NEAR(std::sqrt(sum), UOf(result, "N"), 1e-9);
}

TEST_F(RolesTest, ThePlainResidualIsAvailableAndWarnedOf) {
  const Json depth = Refined(data_), plane = Refined(data_, 0, {"--residual=plane"});
  EXPECT_EQ(depth["residual"], "depth");
  EXPECT_EQ(plane["residual"], "plane");
  EXPECT_THAT(Sentences(plane, "warnings"), HasSubstr("biased"));
  for (const char* name : {"M", "N"}) {
    EXPECT_NE(ValueOf(plane, name), ValueOf(depth, name));
    EXPECT_NEAR(ValueOf(plane, name), ValueOf(depth, name), UOf(depth, name));
  }
}

}  // namespace
}  // namespace scancal
