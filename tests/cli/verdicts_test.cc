// Refusals and verdicts by name: the table of docs/turntable.md, section 6, through the program.
#include <gmock/gmock.h>
#include "tests/cli/plane_scene.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class VerdictsOfProgramTest : public CliTest {
 protected:
  fs::path Write(const PlaneScene& scene, const std::string& more_yaml = "") const {
    WriteScene(Path("scene"), scene, more_yaml);
    return Path("scene");
  }
  std::string Refusal(const fs::path& data) const {
    const Outcome outcome = Refine(data);
    EXPECT_EQ(outcome.exit_code, 1) << ::testing::PrintToString(outcome);
    EXPECT_FALSE(fs::exists(Path("out") / "calibration.json"));
    return OneSentence(outcome);
  }
};

TEST_F(VerdictsOfProgramTest, GoodPlanesAreTrusted) {
  const Json result = Refined(Write({.planes = {{-25, 12}, {0, -8}, {25, 16}}}));
  EXPECT_THAT(Sentences(result, "unreliable"), IsEmpty());
  EXPECT_THAT(Sentences(result, "warnings"), IsEmpty());
  EXPECT_NEAR(ValueOf(result, "M"), 123, 4 * UOf(result, "M"));
  EXPECT_NEAR(ValueOf(result, "N"), 409, 4 * UOf(result, "N"));
  EXPECT_LT(UOf(result, "M"), 0.05);
}

TEST_F(VerdictsOfProgramTest, OnePlacementIsComputedButUnreliable) {
  const Json result = Refined(Write({.planes = {{0, 10}}}), 2);
  EXPECT_GT(UOf(result, "M"), 0.01);
  EXPECT_LT(UOf(result, "M"), 5);
  EXPECT_NEAR(ValueOf(result, "M"), 123, 4 * UOf(result, "M"));
  EXPECT_NEAR(ValueOf(result, "N"), 409, 4 * UOf(result, "N"));
  EXPECT_THAT(Sentences(result, "unreliable"),
              AllOf(HasSubstr("only one placement"), HasSubstr("M suffers most"), HasSubstr("add a placement"),
                    HasSubstr("turned about the vertical by 20 deg")));
}

TEST_F(VerdictsOfProgramTest, ParallelPlacementsAreComputedButUnreliable) {
  const Json result = Refined(Write({.planes = {{10, 10, 480}, {12, 11, 470}, {11, 9, 460}}}), 2);
  EXPECT_NEAR(ValueOf(result, "M"), 123, 4 * UOf(result, "M"));
  EXPECT_NEAR(ValueOf(result, "N"), 409, 4 * UOf(result, "N"));
  EXPECT_THAT(Sentences(result, "unreliable"), AllOf(HasSubstr("the normals of all placements lie within"),
                                                     HasSubstr(" suffers most"), HasSubstr("add a placement")));
  // The one that suffers is the one with the larger u.
  const std::string worse = UOf(result, "M") > UOf(result, "N") ? "M" : "N";
  EXPECT_THAT(Sentences(result, "unreliable"), HasSubstr(worse + " suffers most"));
}

TEST_F(VerdictsOfProgramTest, AScanOfTwoPlanesIsTold) {
  const fs::path data = MakeData();
  std::vector<ScanPoint> half = ReadPoints(data / "left.csv"), other = ReadPoints(data / "right.csv");
  std::erase_if(half, [](const ScanPoint& p) { return p.angle > 0; });
  std::erase_if(other, [](const ScanPoint& p) { return p.angle <= 0; });
  half.insert(half.end(), other.begin(), other.end());
  WritePoints(data / "left.csv", half);
  fs::remove(data / "right.csv");
  Replace(data / "dataset.yaml", "  - {name: right, scan: right.csv}\n", "");
  const std::string first = Refined(data, 2)["unreliable"][0];
  EXPECT_THAT(first,
              AllOf(HasSubstr("target left: the scan holds more than one plane"), HasSubstr("crop it with keep")));
}

TEST_F(VerdictsOfProgramTest, AStepWithinTheProfilesIsTold) {
  const fs::path data = MakeData();
  EXPECT_THAT(Sentences(Refined(data), "unreliable"), IsEmpty());
  std::vector<ScanPoint> points = ReadPoints(data / "left.csv");
  for (ScanPoint& p : points)
    if (p.z > 5) p.y += 0.5;  // ten standard deviations
  WritePoints(data / "left.csv", points);
  const std::string first = Refined(data, 2)["unreliable"][0];
  EXPECT_THAT(first, AllOf(HasSubstr("target left: its profiles are two lines rather than one"),
                           HasSubstr("an edge or a step: crop it with keep")));
}

TEST_F(VerdictsOfProgramTest, PlacementsSixDegreesApartAreDifferent) {
  const Json result = Refined(Write({.planes = {{0, 10, 480}, {6.5, 10, 470}}}));
  EXPECT_THAT(Sentences(result, "unreliable"), IsEmpty());
}

TEST_F(VerdictsOfProgramTest, TheUnreliableResultIsPrintedWithItsReason) {
  const Outcome outcome = Refine(Write({.planes = {{0, 10}}}));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("\nunreliable: there is only one placement"),
                                 HasSubstr("\nstatus: unreliable\n"), HasSubstr("\nM  ")));
}

TEST_F(VerdictsOfProgramTest, HorizontalPlanesDetermineNothing) {
  const fs::path data = Write({.planes = {{0, 10}, {0, 12}}});
  for (const auto& [name, height] : {std::pair{"plane_1", 20.0}, std::pair{"plane_2", -35.0}}) {
    std::vector<ScanPoint> points;
    for (int i = 0; i < 40; ++i)
      for (int j = 0; j < 20; ++j) points.push_back({i - 20.0, 50.0 + 5 * j, height + 0.001 * ((7 * j + 3 * i) % 5)});
    WritePoints(data / (std::string(name) + ".csv"), points);
  }
  EXPECT_THAT(Refusal(data), AllOf(HasSubstr("M, N: not determined"), HasSubstr("perpendicular to the axis"),
                                   HasSubstr("stand the plate up")));
}

TEST_F(VerdictsOfProgramTest, WithoutASweepNothingIsDetermined) {
  EXPECT_THAT(Refusal(Write({.sweep = 0, .planes = {{-25, 12}, {0, -8}, {25, 16}}})),
              AllOf(HasSubstr("M, N: not determined"), HasSubstr("one angle only"), HasSubstr("must turn")));
}

TEST_F(VerdictsOfProgramTest, YawIsNoParameter) {
  const std::string sentence = Refusal(Write({.planes = {{0, 10}, {25, 16}}}, "parameters: {yaw: estimate}\n"));
  EXPECT_THAT(sentence, AllOf(HasSubstr("dataset.yaml"), HasSubstr("parameters: yaw: not determined by planes"),
                              HasSubstr("remove it")));
}

TEST_F(VerdictsOfProgramTest, AScaleNeedsAPrior) {
  for (const std::string scale : {"scale_y", "scale_z"}) {
    const std::string sentence =
        Refusal(Write({.planes = {{0, 10}, {25, 16}}}, "parameters: {" + scale + ": estimate}\n"));
    EXPECT_THAT(sentence, AllOf(HasSubstr("dataset.yaml"), HasSubstr("parameters: " + scale + ": not determined"),
                                HasSubstr("give a prior, {estimate: 0, u: ...}")));
  }
}

TEST_F(VerdictsOfProgramTest, AScaleWithAPriorKeepsIt) {
  const Json result =
      Refined(Write({.planes = {{-25, 12}, {0, -8}, {25, 16}}}, "parameters: {scale_y: {estimate: 0, u: 0.001}}\n"));
  EXPECT_NEAR(UOf(result, "scale_y"), 0.001, 1e-5);  // the planes say nothing about it
  EXPECT_NEAR(ValueOf(result, "scale_y"), 0, 1e-5);
  EXPECT_NEAR(UOf(result, "N"), 0.409, 0.03);  // dN/ds = N
}

TEST_F(VerdictsOfProgramTest, ANarrowSweepHasAHugeHonestUncertainty) {
  const Json result = Refined(
      Write({.sweep = 3, .planes = {{-25, 12}, {0, -8}, {25, 16}}}, "parameters: {N: {estimate: 409, u: 50}}\n"));
  EXPECT_THAT(Sentences(result, "warnings"), AllOf(HasSubstr("the sweep of 3 deg is too narrow"), HasSubstr("wider")));
  EXPECT_GT(UOf(result, "N"), 0.3);
  EXPECT_NEAR(ValueOf(result, "M"), 123, 4 * UOf(result, "M"));
  EXPECT_NEAR(ValueOf(result, "N"), 409, 4 * UOf(result, "N"));
}

TEST_F(VerdictsOfProgramTest, AMinimumOnTheEdgeIsUnreliable) {
  const fs::path data = Write({.planes = {{-25, 12}, {0, -8}, {25, 16}}});
  Replace(data / "dataset.yaml", "[110, 130]", "[100, 115]");
  const Json result = Refined(data, 2);
  EXPECT_THAT(Sentences(result, "unreliable"),
              AllOf(HasSubstr("M = 115"), HasSubstr("on the edge of the search interval"), HasSubstr("widen search")));
  EXPECT_EQ(result["grid"]["M"], 115);
  EXPECT_NEAR(ValueOf(result, "M"), 123, 4 * UOf(result, "M"));  // the refinement leaves the interval all the same
}

TEST_F(VerdictsOfProgramTest, AResultOutsideTheSearchIntervalIsNotTrusted) {
  const fs::path data = MakeData();  // a scan of nothing: every depth is 0
  std::vector<ScanPoint> points = ReadPoints(data / "left.csv");
  for (ScanPoint& p : points) p.y = 0;
  WritePoints(data / "left.csv", points);
  const Outcome outcome = Refine(data);
  EXPECT_EQ(outcome.exit_code, 2) << ::testing::PrintToString(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("outside the search interval"));
}

TEST_F(VerdictsOfProgramTest, NoConvergenceIsUnreliable) {
  // One iteration and the polishing steps suffice nearly always: not for tilts seen through noise and a narrow sweep.
  const fs::path data = Path("noisy");
  Simulate(data, {"--profiles=40", "--points=20", "--sweep=2", "--noise=1"});
  Append(data / "dataset.yaml", "parameters: {tilt_x: estimate, tilt_y: estimate}\n");
  const Json result = Refined(data, 2, {"--max_iterations=1", "--weights=equal"});
  EXPECT_EQ(result["converged"], false);
  const std::string reasons = Sentences(result, "unreliable");
  EXPECT_THAT(reasons, HasSubstr("did not converge"));
  EXPECT_THAT(reasons, HasSubstr("more iterations")) << "names no remedy";
  EXPECT_TRUE(reasons.find("tilt_x") != std::string::npos || reasons.find("tilt_y") != std::string::npos ||
              reasons.find("M ") != std::string::npos || reasons.find("N ") != std::string::npos)
      << "names no parameter: " << reasons;
}

TEST_F(VerdictsOfProgramTest, OneIterationIsEnoughForGoodData) {
  const fs::path data = MakeData();
  const Json many = Refined(data), one = Refined(data, 0, {"--max_iterations=1"});
  EXPECT_NEAR(ValueOf(one, "M"), ValueOf(many, "M"), 1e-8);
  EXPECT_NEAR(ValueOf(one, "N"), ValueOf(many, "N"), 1e-8);
}

TEST_F(VerdictsOfProgramTest, ADisagreeingPlacementIsWarnedOf) {
  // One placement seen with another M: the jackknife notices.
  PlaneScene scene{.planes = {{-25, 12}, {0, -8}, {25, 16}, {10, -15}}};
  const fs::path data = Write(scene);
  PlaneScene other = scene;
  other.M = 124;
  WritePoints(data / "plane_4.csv", ScanOf(other, scene.planes[3], 3));
  const Outcome outcome = Refine(data);
  EXPECT_THAT(Sentences(Result(), "warnings"), HasSubstr("the targets disagree"));
  EXPECT_EQ(outcome.err, "");
}

}  // namespace
}  // namespace scancal
