// calibration.json: its keys, its consistency, its hashes.
#include <gmock/gmock.h>
#include <cstdio>
#include "tests/cli/data_set.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ResultTest : public CliTest {
 protected:
  const fs::path data_ = MakeData();
  const Json result_ = Refined(data_, 0, {"--max_iterations=50"});
};

// By coreutils, as anyone would check it.
std::string Sha256Sum(const fs::path& file) {
  const fs::path link = fs::temp_directory_path() / ("scancal-" + std::to_string(::getpid()));  // no quoting
  fs::remove(link);
  fs::create_symlink(file, link);
  std::FILE* const pipe = ::popen(("sha256sum " + link.string()).c_str(), "r");
  char digits[65] = {};
  EXPECT_EQ(std::fread(digits, 1, 64, pipe), 64U);
  ::pclose(pipe);
  fs::remove(link);
  return digits;
}

void ExpectFinite(const Json& json, const std::string& where) {
  if (json.is_number_float()) {
    EXPECT_TRUE(std::isfinite(json.get<double>())) << where;
  }
  if (json.is_structured())
    for (const auto& item : json.items()) ExpectFinite(item.value(), where + "/" + item.key());
}

TEST_F(ResultTest, EveryKeyOfTheSpecificationIsThere) {
  for (const char* key : {"scancal",   "model",   "status",  "warnings",         "parameters",  "covariance",
                          "grid",      "targets", "sigma",   "pure_error_sigma", "lack_of_fit", "condition",
                          "weakest",   "budget",  "compare", "surface",          "jackknife",   "montecarlo",
                          "residuals", "volume",  "data",    "inputs",           "command",     "version"})
    EXPECT_TRUE(result_.contains(key)) << key;
  for (const char* key :
       {"name", "unit", "role", "value", "u", "k", "U", "dof", "u_naive", "u_clustered", "u_jackknife", "u_bootstrap"})
    EXPECT_TRUE(ParameterOf(result_, "M").contains(key)) << key;
  for (const char* key : {"step", "S", "M", "N", "nodes"}) EXPECT_TRUE(result_["grid"].contains(key)) << key;
  for (const char* key : {"name", "points", "set_aside", "normal", "distance", "rms"})
    EXPECT_TRUE(result_["targets"][0].contains(key)) << key;
  for (const char* key : {"F", "dof1", "dof2", "p"}) EXPECT_TRUE(result_["lack_of_fit"].contains(key)) << key;
  for (const char* key : {"source", "type", "value", "unit", "sensitivity", "u", "share", "dof"})
    EXPECT_TRUE(result_["budget"][0].contains(key)) << "budget: " << key;
  for (const char* key : {"layout", "targets", "sha256", "segments", "dataset"})
    EXPECT_TRUE(result_["data"].contains(key)) << key;
  for (const char* key : {"file", "sha256"}) EXPECT_TRUE(result_["inputs"][0].contains(key)) << key;
}

TEST_F(ResultTest, ValuesAreOfTheRightKind) {
  EXPECT_EQ(result_["scancal"], 1);
  EXPECT_EQ(result_["model"], "turntable");
  EXPECT_EQ(result_["status"], "ok");
  EXPECT_TRUE(result_["warnings"].is_array());
  for (const char* list : {"compare", "jackknife", "budget"}) EXPECT_TRUE(result_[list].is_array()) << list;
  for (const char* object : {"surface", "montecarlo", "residuals", "volume", "data", "weakest"})
    EXPECT_TRUE(result_[object].is_object()) << object;
  EXPECT_TRUE(result_["version"].is_string());
  ExpectFinite(result_, "");
}

TEST_F(ResultTest, TheCovarianceIsSymmetricAndAgreesWithU) {
  for (const std::vector<std::string>& flags : {std::vector<std::string>{}, {"--residual=plane"}}) {
    Json result = Refined(data_, 0, flags);
    const Json& v = result["covariance"];
    const Json& names = result["covariance_of"];
    ASSERT_EQ(v.size(), 2U);
    ASSERT_EQ(names.size(), 2U);
    for (size_t i = 0; i < v.size(); ++i) {
      ASSERT_EQ(v[i].size(), v.size());
      const double u = UOf(result, names[i]);
      EXPECT_NEAR(std::sqrt(v[i][i].get<double>()), u, 1e-12 * u);
      for (size_t j = 0; j < i; ++j) {
        const double scale = std::sqrt(v[i][i].get<double>() * v[j][j].get<double>());
        EXPECT_NEAR(v[i][j].get<double>(), v[j][i].get<double>(), 1e-12 * scale);
        EXPECT_LT(std::abs(v[i][j].get<double>()), scale);
      }
    }
  }
}

TEST_F(ResultTest, UIsOfTheWeightedFitAndTheOthersStandBesideIt) {
  for (const char* name : {"M", "N"}) {
    const Json& p = ParameterOf(result_, name);
    EXPECT_NEAR(p["U"], p["k"].get<double>() * p["u"].get<double>(), 1e-12);
    EXPECT_GT(p["dof"].get<double>(), 60);  // 120 profiles tell the variances
    EXPECT_GT(p["k"].get<double>(), 1.96);
    EXPECT_LT(p["k"].get<double>(), 2.01);
    EXPECT_NEAR(p["u_clustered"].get<double>() / p["u"].get<double>(), 1, 0.4);
    EXPECT_NEAR(p["u_naive"].get<double>() / p["u"].get<double>(), 1, 0.4);  // white noise
  }
  EXPECT_GT(result_["joint"]["k"].get<double>(), ParameterOf(result_, "M")["k"].get<double>());
}

TEST_F(ResultTest, EqualWeightsHaveTheClusteredU) {
  const Json equal = Refined(data_, 0, {"--weights=equal"});
  for (const char* name : {"M", "N"}) {
    const Json& p = ParameterOf(equal, name);
    EXPECT_NEAR(p["dof"], 109, 1e-9);       // 120 profiles less M, N and three planes of three
    EXPECT_NEAR(p["k"], 1.98196749, 1e-6);  // Student's t, 97.5 %, 109
    EXPECT_NEAR(p["u"], p["u_clustered"], 1e-12);
    EXPECT_EQ(p["u_naive"], ParameterOf(result_, name)["u_naive"]);
  }
}

TEST_F(ResultTest, TargetsAddUp) {
  ASSERT_EQ(result_["targets"].size(), 3U);
  const auto truth = ReadJson(data_ / "truth.json");
  ASSERT_TRUE(truth.ok());
  for (size_t t = 0; t < 3; ++t) {
    const Json& target = result_["targets"][t];
    EXPECT_EQ(target["name"], kNames[t]);
    EXPECT_EQ(target["points"].get<double>() + target["set_aside"].get<double>() + target["missing"].get<double>(),
              800);
    EXPECT_NEAR(target["rms"], 0.05, 0.005);
    double length = 0, cosine = 0;
    for (size_t i = 0; i < 3; ++i) {
      const double n = target["normal"][i];
      length += n * n;
      cosine += n * (*truth)["targets"][t]["normal"][i].get<double>();
    }
    EXPECT_NEAR(length, 1, 1e-12);
    EXPECT_GT(cosine, 1 - 1e-6);
    EXPECT_NEAR(target["distance"], (*truth)["targets"][t]["distance"], 0.6);
  }
  EXPECT_EQ(result_["jackknife"].size(), 3U);
  EXPECT_EQ(result_["jackknife"][0]["without"], "left");
}

TEST_F(ResultTest, HashesAreThoseOfTheFiles) {
  ASSERT_EQ(result_["inputs"].size(), 4U);
  EXPECT_EQ(result_["inputs"][0]["file"], "dataset.yaml");
  for (const Json& input : result_["inputs"])
    EXPECT_EQ(input["sha256"], Sha256Sum(data_ / input["file"].get<std::string>())) << input["file"];
}

TEST_F(ResultTest, TheCommandIsKept) {
  const std::string command = result_["command"];
  EXPECT_THAT(command, AllOf(HasSubstr("scancal refine"), HasSubstr("--max_iterations=50")));
}

TEST_F(ResultTest, TheCommandCanBeRunAgain) {
  // Through a shell: the test's folder has blanks and an apostrophe.
  const std::string command = result_["command"];
  fs::rename(Path("out"), Path("before"));
  EXPECT_EQ(std::system((command + " > /dev/null 2>&1").c_str()), 0) << command;
  EXPECT_TRUE(fs::exists(Path("out") / "calibration.json"));
}

TEST_F(ResultTest, AnUnreliableResultSaysSo) {
  Replace(data_ / "dataset.yaml", "[110, 130]", "[100, 115]");
  const Json result = Refined(data_, 2);
  EXPECT_EQ(result["status"], "unreliable");
  EXPECT_FALSE(result["unreliable"].empty());
}

TEST_F(ResultTest, TheOldResultIsReplacedWhole) {
  WriteWhole(Path("out") / "calibration.json", std::string(100000, 'x'));
  const Json result = Refined(data_);
  EXPECT_EQ(ValueOf(result, "M"), ValueOf(result_, "M"));
  EXPECT_EQ(std::distance(fs::directory_iterator(Path("out")), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace scancal
