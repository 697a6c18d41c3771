#include "io/dataset.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include "tests/io/temporary_folder.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class DatasetTest : public ::testing::Test {
 protected:
  Result<Dataset> Read(const std::string& contents) {
    folder_.Write("dataset.yaml", contents);
    return ReadDataset(folder_.path());
  }
  // A sound data set with these lines in addition.
  Result<Dataset> ReadWith(const std::string& lines) {
    return Read("scancal: 1\nmodel: turntable\nunits: {length: m, angle: rad}\n" + lines);
  }
  std::string Error(const std::string& lines) {
    const auto dataset = ReadWith(lines);
    return dataset.ok() ? "" : dataset.error().message;
  }
  std::string ErrorOf(const std::string& contents) {
    const auto dataset = Read(contents);
    return dataset.ok() ? "" : dataset.error().message;
  }

  TemporaryFolder folder_;
};

TEST_F(DatasetTest, ReadsWhatEveryModelShares) {
  auto dataset = ReadWith(
      "name: a plate\n"
      "parameters: {M: {estimate: 123, u: 0.5}, N: {hold: 409}, tilt_x: estimate, tilt_y: {consider: 0, u: 0.0005}, "
      "beta: hold, gamma: {estimate: 2}}\n"
      "influences: {noise_y: 0.05, encoder_jitter: estimate, flatness: 0}\n"
      "certificate: {owner: lab}\n"
      "rotation: clockwise\n");
  ASSERT_TRUE(dataset.ok()) << dataset.error().message;
  EXPECT_EQ(dataset->file, folder_.path() / "dataset.yaml");
  EXPECT_EQ(dataset->model, "turntable");
  EXPECT_EQ(dataset->name, "a plate");
  EXPECT_EQ(dataset->units.length, "m");
  EXPECT_EQ(dataset->units.length_in_mm, 1000);
  EXPECT_EQ(dataset->units.angle_in_rad, 1);
  ASSERT_TRUE(dataset->certificate);
  EXPECT_EQ(dataset->certificate->at("owner").get<std::string>(), "lab");

  ASSERT_EQ(dataset->parameters.size(), 6U);
  const auto& parameters = dataset->parameters;
  EXPECT_EQ(parameters[0].name, "M");
  EXPECT_EQ(parameters[0].role, "estimate");
  EXPECT_EQ(parameters[0].value, 123);
  EXPECT_EQ(parameters[0].u, 0.5);
  EXPECT_EQ(parameters[1].role, "hold");
  EXPECT_EQ(parameters[1].value, 409);
  EXPECT_EQ(parameters[2].role, "estimate");
  EXPECT_EQ(parameters[2].value, std::nullopt);
  EXPECT_EQ(parameters[2].u, 0);
  EXPECT_EQ(parameters[3].role, "consider");
  EXPECT_EQ(parameters[3].value, 0);
  EXPECT_EQ(parameters[3].u, 0.0005);
  EXPECT_EQ(parameters[4].role, "hold");
  EXPECT_EQ(parameters[4].value, std::nullopt);
  EXPECT_EQ(parameters[5].value, 2);
  EXPECT_EQ(parameters[5].u, 0);

  ASSERT_EQ(dataset->influences.size(), 3U);
  EXPECT_EQ(dataset->influences[0].name, "noise_y");
  EXPECT_EQ(dataset->influences[0].u, 0.05);
  EXPECT_EQ(dataset->influences[0].role, "consider");
  EXPECT_EQ(dataset->influences[1].role, "estimate");
  EXPECT_EQ(dataset->influences[2].u, 0);

  EXPECT_THAT(dataset->yaml.Finish().error().message, HasSubstr("unknown key 'rotation'"));
  EXPECT_EQ(dataset->yaml.Text("rotation"), "clockwise");
  EXPECT_TRUE(dataset->yaml.Finish().ok());
}

TEST_F(DatasetTest, OptionalPartsMayBeAbsent) {
  const auto dataset = ReadWith("");
  ASSERT_TRUE(dataset.ok()) << dataset.error().message;
  EXPECT_THAT(dataset->name, IsEmpty());
  EXPECT_THAT(dataset->parameters, IsEmpty());
  EXPECT_FALSE(dataset->certificate);
  EXPECT_TRUE(dataset->yaml.Finish().ok());
}

TEST_F(DatasetTest, TheFileItselfMayBeNamed) {
  ASSERT_TRUE(ReadWith("").ok());
  std::filesystem::rename(folder_.path() / "dataset.yaml", folder_.path() / "other's name.yaml");
  const auto dataset = ReadDataset(folder_.path() / "other's name.yaml");
  ASSERT_TRUE(dataset.ok()) << dataset.error().message;
  EXPECT_EQ(dataset->file, folder_.path() / "other's name.yaml");
}

TEST_F(DatasetTest, AFolderWithoutADataSetIsAnError) {
  EXPECT_EQ(ReadDataset(folder_.path()).error().message, (folder_.path() / "dataset.yaml").string() + ": no such file");
}

TEST_F(DatasetTest, AnotherVersionIsAnError) {
  EXPECT_THAT(ErrorOf("scancal: 2\nfuture: {}\n"),
              AllOf(HasSubstr("dataset.yaml:1:10: scancal: found \"2\", expected 1"),
                    EndsWith("the data set is made for a newer scancal")));
  EXPECT_THAT(ErrorOf("scancal: 0\n"), EndsWith("found \"0\", expected 1, the version of the format"));
  EXPECT_THAT(ErrorOf("scancal: one\n"), HasSubstr("found \"one\", expected a number"));
  EXPECT_THAT(ErrorOf("model: turntable\n"), HasSubstr("the key 'scancal' is missing"));
}

TEST_F(DatasetTest, ModelAndUnitsAreRequired) {
  EXPECT_THAT(ErrorOf("scancal: 1\nunits: {length: mm, angle: deg}\n"), HasSubstr("the key 'model' is missing"));
  EXPECT_THAT(ErrorOf("scancal: 1\nmodel: x\n"), HasSubstr("the key 'units' is missing"));
  EXPECT_THAT(ErrorOf("scancal: 1\nmodel: x\nunits: {length: mm}\n"), HasSubstr("the key 'angle' is missing"));
}

TEST_F(DatasetTest, UnknownUnitsAreErrors) {
  EXPECT_THAT(ErrorOf("scancal: 1\nmodel: x\nunits: {length: inch, angle: deg}\n"),
              HasSubstr("dataset.yaml:3:17: units: length: found \"inch\", expected mm, m or um"));
  EXPECT_THAT(ErrorOf("scancal: 1\nmodel: x\nunits: {length: mm, angle: gon}\n"),
              HasSubstr(":3:28: units: angle: found \"gon\", expected deg or rad"));
}

TEST_F(DatasetTest, UnknownRolesAreErrors) {
  EXPECT_THAT(Error("parameters: {M: estimte}\n"),
              AllOf(HasSubstr(":4:17: parameters: M: found \"estimte\", expected estimate, hold, "),
                    EndsWith("did you mean 'estimate'?")));
  EXPECT_THAT(Error("parameters: {M: 409}\n"), HasSubstr("found \"409\", expected estimate, hold, {hold: value}"));
  EXPECT_THAT(Error("parameters: {M: {estimat: 1, u: 1}}\n"),
              EndsWith("parameters: M: estimat: unknown role 'estimat', did you mean 'estimate'?"));
  EXPECT_THAT(Error("parameters: {M: {u: 1}}\n"),
              EndsWith("parameters: M: found no role, expected one of: estimate, consider, hold"));
  EXPECT_THAT(Error("parameters: {M: [1]}\n"), EndsWith("parameters: M: found a list, expected text"));
  EXPECT_THAT(Error("parameters: 5\n"), EndsWith("parameters: found \"5\", expected a mapping"));
}

TEST_F(DatasetTest, TwoRolesAtOnceAreAnError) {
  EXPECT_THAT(Error("parameters: {M: {estimate: 1, hold: 1}}\n"),
              EndsWith(":4:17: parameters: M: found the roles estimate, hold, expected one of them"));
}

TEST_F(DatasetTest, AConsideredParameterNeedsItsUncertainty) {
  EXPECT_THAT(Error("parameters: {M: consider}\n"),
              EndsWith("M: found \"consider\", expected its standard uncertainty as well: {consider: 0, u: ...}"));
  EXPECT_THAT(Error("parameters: {M: {consider: 0}}\n"), EndsWith("M: the key 'u' is missing, expected a number"));
  EXPECT_THAT(Error("parameters: {M: {consider: 0, u: 0}}\n"),
              EndsWith("M: u: found \"0\", expected more than 0; without uncertainty it is {hold: ...}"));
}

TEST_F(DatasetTest, UncertaintiesAreNotNegative) {
  EXPECT_THAT(Error("parameters: {M: {consider: 0, u: -1}}\n"),
              EndsWith("M: u: found \"-1\", expected a standard uncertainty, not negative"));
  EXPECT_THAT(Error("parameters: {M: {estimate: 0, u: -1}}\n"),
              EndsWith("M: u: found \"-1\", expected a standard uncertainty, not negative"));
}

TEST_F(DatasetTest, AHeldParameterHasNoUncertainty) {
  EXPECT_THAT(Error("parameters: {M: {hold: 0, u: 1}}\n"), HasSubstr("M: u: a parameter on hold has no uncertainty"));
}

TEST_F(DatasetTest, InfluencesAreUncertaintiesOrEstimated) {
  const std::string expected = "expected a standard uncertainty of 0 or more, or estimate";
  EXPECT_THAT(Error("influences: {noise_y: -0.1}\n"), EndsWith("influences: noise_y: found \"-0.1\", " + expected));
  EXPECT_THAT(Error("influences: {noise_y: big}\n"), EndsWith("influences: noise_y: found \"big\", " + expected));
  EXPECT_THAT(Error("influences: {noise_y: {u: 1}}\n"), HasSubstr("noise_y: found no role"));
  EXPECT_THAT(Error("influences: {noise_y: inf}\n"), EndsWith("found \"inf\", " + expected));
}

TEST_F(DatasetTest, DuplicateKeysAreErrors) {
  EXPECT_THAT(Error("parameters:\n  M: hold\n  M: estimate\n"),
              EndsWith("dataset.yaml:6:3: the key 'M' stands here a second time, first in line 5"));
}

}  // namespace
}  // namespace scancal
