// Damaged declarations, seen from outside: dataset.yaml and its units.
#include "io/units.h"
#include "tests/cli/bad_input.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class BadDeclarationTest : public BadInputTest {};

TEST_F(BadDeclarationTest, AMissingDataSetIsNamed) {
  fs::remove(yaml_);
  ExpectRefused(yaml_.string() + ": no such file");
}

TEST_F(BadDeclarationTest, AnEmptyDataSetIsTold) {
  WriteWhole(yaml_, "");
  ExpectRefused(StartsWith(yaml_.string() + ": the file is empty, expected"));
}

TEST_F(BadDeclarationTest, AnUnknownKeyIsRefusedWithTheNearestOne) {
  Append(yaml_, "rotaton: clockwise\n");
  ExpectRefused(yaml_.string() + ":11:1: unknown key 'rotaton', did you mean 'rotation'?");
}

TEST_F(BadDeclarationTest, AKeyOfATargetIsChecked) {
  Replace(yaml_, "scan: left.csv", "scan: left.csv, kep: {angle: [-1, 1]}");
  ExpectRefused(AllOf(StartsWith(yaml_.string() + ":8:"), HasSubstr("'kep'"), HasSubstr("did you mean 'keep'?")));
}

TEST_F(BadDeclarationTest, AFolderIsNoDataSetFile) {
  fs::remove(yaml_);
  fs::create_directory(yaml_);
  ExpectRefused(yaml_.string() + ": found a folder, expected a file");
}

TEST_F(BadDeclarationTest, NamesOfTargetsAreDifferent) {
  Replace(yaml_, "name: right", "name: left");
  ExpectRefused(AllOf(StartsWith(yaml_.string() + ":10:"), HasSubstr("name: found \"left\""), HasSubstr("no other")));
}

TEST_F(BadDeclarationTest, UncertaintiesAreNotNegative) {
  Append(yaml_, "parameters: {tilt_x: {consider: 0, u: -0.1}}\n");
  ExpectRefused(AllOf(StartsWith(yaml_.string() + ":11:"), HasSubstr("tilt_x: u: found \"-0.1\", expected")));
}

TEST_F(BadDeclarationTest, InfluencesAreNotNegative) {
  Append(yaml_, "influences: {noise_y: -1}\n");
  ExpectRefused(AllOf(StartsWith(yaml_.string() + ":11:"), HasSubstr("noise_y: found \"-1\", expected")));
}

TEST_F(BadDeclarationTest, AnIntervalUpsideDownIsRefused) {
  Replace(yaml_, "[110, 130]", "[130, 110]");
  ExpectRefused(
      AllOf(StartsWith(yaml_.string() + ":6:"), HasSubstr("search: M: found [130, 110], expected the lower")));
}

TEST_F(BadDeclarationTest, AKeepIntervalUpsideDownIsRefused) {
  Replace(yaml_, "scan: left.csv", "scan: left.csv, keep: {angle: [5, -5]}");
  ExpectRefused(AllOf(StartsWith(yaml_.string() + ":8:"), HasSubstr("keep: angle: found [5, -5], expected the lower")));
}

TEST_F(BadDeclarationTest, DegreesDeclaredAsRadians) {
  Replace(yaml_, "angle: deg", "angle: rad");
  ExpectRefused(AllOf(HasSubstr("left"), HasSubstr("span 30 rad"), HasSubstr("degrees declared as rad")));
}

TEST_F(BadDeclarationTest, RadiansDeclaredAsDegrees) {
  ScaleColumns(kDegree, 1);
  ExpectRefused(AllOf(HasSubstr("span 0.524 deg"), HasSubstr("declare angle: rad")));
}

TEST_F(BadDeclarationTest, MillimetresDeclaredAsMetres) {
  Replace(yaml_, "length: mm", "length: m");
  ExpectRefused(
      AllOf(StartsWith(yaml_.string() + ":6:"), HasSubstr("search: M"), HasSubstr("is units: length: right?")));
  Replace(yaml_, "search: {M: [110, 130], N: [395, 425], step: 1}",
          "search: {M: [0.11, 0.13], N: [0.395, 0.425], step: 0.001}");
  ExpectRefused(AllOf(HasSubstr("left"), HasSubstr("mm declared as m")));
}

TEST_F(BadDeclarationTest, MetresDeclaredAsMillimetres) {
  ScaleColumns(1, 0.001);
  ExpectRefused(AllOf(HasSubstr("0.2267 mm"), HasSubstr("m declared as mm")));
}

TEST_F(BadDeclarationTest, MillimetresDeclaredAsMicrometres) {
  Replace(yaml_, "length: mm", "length: um");
  ExpectRefused(AllOf(HasSubstr("0.2267 mm"), HasSubstr("um")));
}

TEST_F(BadDeclarationTest, AnotherModelIsUnknown) {
  Replace(yaml_, "model: turntable", "model: turntabel");
  ExpectRefused(AllOf(StartsWith(yaml_.string() + ":2:8: model: found \"turntabel\", expected"),
                      HasSubstr("expected one of: turntable, robot-ball")));
}

}  // namespace
}  // namespace scancal
