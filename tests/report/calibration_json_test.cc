#include "report/calibration_json.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include "tests/report/some_calibration.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(CalibrationJsonTest, ValuesArriveUnderTheirKeys) {
  const Json json = ToJson(SomeCalibration());
  EXPECT_EQ(json["scancal"], 1);
  EXPECT_EQ(json["status"], "ok");
  EXPECT_EQ(json["parameters"][0]["name"], "M");
  EXPECT_EQ(json["parameters"][0]["role"], "estimate");
  EXPECT_EQ(json["parameters"][0]["unit"], "mm");
  EXPECT_EQ(json["parameters"][2]["role"], "consider");
  EXPECT_EQ(json["parameters"][2]["unit"], "rad");
  EXPECT_EQ(json["parameters"][2]["u"], 2e-4);
  EXPECT_EQ(json["parameters"][3]["role"], "hold");
  EXPECT_EQ(json["covariance"], Json({{1.21e-4, 3e-5}, {3e-5, 4e-4}}));
  EXPECT_EQ(json["covariance_of"], Json({"M", "N"}));
  EXPECT_EQ(json["targets"][0]["set_aside"], 7);
  EXPECT_EQ(json["targets"][0]["missing"], 3);
  EXPECT_EQ(json["targets"][0]["distance"], 480);
  EXPECT_EQ(json["targets"][0]["normal"], Json({0.0, -1.0, 0.0}));
  EXPECT_EQ(json["grid"]["M"], 123);
  EXPECT_EQ(json["inputs"][0]["sha256"], "abc");
}

TEST(CalibrationJsonTest, WhatALaterCommandNeedsComesBack) {
  const Calibration before = SomeCalibration();
  // Through text, as on disk.
  const auto after = CalibrationFromJson(Json::parse(ToJson(before).dump(2)), "calibration.json");
  ASSERT_TRUE(after.ok()) << after.error().message;
  EXPECT_EQ(after->model, before.model);
  EXPECT_TRUE(after->ok());
  ASSERT_EQ(after->parameters.size(), before.parameters.size());
  for (size_t k = 0; k < before.parameters.size(); ++k) {
    EXPECT_EQ(after->parameters[k].name, before.parameters[k].name);
    EXPECT_EQ(after->parameters[k].value, before.parameters[k].value);  // to the last digit
  }
}

TEST(CalibrationJsonTest, UncertaintiesComeBack) {
  const Calibration before = WithBudgetAndVolume();
  const auto after = CalibrationFromJson(Json::parse(ToJson(before).dump(2)), "calibration.json");
  ASSERT_TRUE(after.ok()) << after.error().message;
  for (size_t k = 0; k < before.parameters.size(); ++k) {
    const Parameter &was = before.parameters[k], &is = after->parameters[k];
    EXPECT_EQ(is.role, was.role);
    EXPECT_EQ(is.unit, was.unit);
    EXPECT_EQ(is.u, was.u);
    if (was.role != Role::kEstimate) continue;
    EXPECT_EQ(std::tuple(is.k, is.U, is.dof), std::tuple(was.k, was.U, was.dof));
  }
  EXPECT_EQ(after->estimated, before.estimated);
  EXPECT_EQ(after->covariance, before.covariance);
  ASSERT_EQ(after->budget.size(), 2u);
  for (size_t k = 0; k < 2; ++k) {
    const BudgetLine &was = before.budget[k], &is = after->budget[k];
    EXPECT_EQ(std::tuple(is.source, is.type, is.unit, is.u, is.dof),
              std::tuple(was.source, was.type, was.unit, was.u, was.dof));
    EXPECT_EQ(is.sensitivity, was.sensitivity);
    EXPECT_EQ(is.contribution, was.contribution);
    EXPECT_EQ(is.share, was.share);
  }
  EXPECT_EQ(after->volume.columns, before.volume.columns);
  EXPECT_EQ(after->volume.units, before.volume.units);
  EXPECT_EQ(after->volume.rows, before.volume.rows);
}

TEST(CalibrationJsonTest, WhatWasNotFiniteComesBackAsNoNumber) {
  Calibration before = WithBudgetAndVolume();
  before.unreliable = {Sentence{"the uncertainties overflow"}};
  before.covariance(0, 1) = before.parameters[0].dof = before.volume.rows[1].back() = INFINITY;
  const auto after = CalibrationFromJson(ToJson(before), "f");
  ASSERT_TRUE(after.ok()) << after.error().message;
  EXPECT_TRUE(std::isnan(after->covariance(0, 1)));
  EXPECT_EQ(after->covariance(1, 1), before.covariance(1, 1));
  EXPECT_EQ(after->parameters[0].dof, INFINITY);
  EXPECT_TRUE(std::isnan(after->volume.rows[1].back()));
}

TEST(CalibrationJsonTest, DamagedUncertaintiesAreErrors) {
  for (const auto& [key, damaged] : std::initializer_list<std::pair<const char*, const char*>>{
           {"covariance_of", R"([5])"},
           {"covariance_of", R"(["M", "no parameter"])"},
           {"covariance", R"([[1, 2]])"},
           {"covariance", R"([[1, 2], [3]])"},
           {"covariance", R"([[-1, 0], [0, 1]])"},
           {"covariance", R"([[1, 0.5], [0.4, 1]])"},
           {"covariance", R"([[1, 2], [2, 1]])"},
           {"covariance", R"([[1, null], [null, 1]])"},
           {"covariance", R"([[1, 2], [3, "4"]])"},
           {"covariance", R"(5)"},
           {"budget", R"({})"},
           {"budget", R"([5])"},
           {"budget", R"([{"source": "tilt_x", "sensitivity": {"M": 1}, "u": {}, "share": {}}])"},
           {"budget", R"([{"sensitivity": {}, "u": {}, "share": {}}])"},
           {"volume", R"(5)"},
           {"volume", R"({"columns": ["X"], "units": [], "rows": []})"},
           {"volume", R"({"columns": ["X"], "units": ["mm"], "rows": [[1, 2]]})"},
           {"volume", R"({"columns": ["X"], "units": ["mm"], "rows": [["1"]]})"}}) {
    Json json = ToJson(WithBudgetAndVolume());
    json[key] = Json::parse(damaged);
    const auto after = CalibrationFromJson(json, "some.json");
    ASSERT_FALSE(after.ok()) << key << damaged;
    EXPECT_THAT(after.error().message, AllOf(StartsWith("some.json: expected "), HasSubstr("calibration.json?")));
  }
}

TEST(CalibrationJsonTest, CarriesCorrelationAndCoverage) {
  Calibration c = WithBudgetAndVolume();
  c.covariance << 4, -3, -3, 9;
  const Json json = ToJson(c);
  EXPECT_EQ(json["correlation"], Json::parse("[[1, -0.5], [-0.5, 1]]"));
  EXPECT_EQ(json["coverage_probability"], 0.95);
}

TEST(CalibrationJsonTest, UncertaintiesThatCannotBeAreErrors) {
  for (const char* key : {"u", "U", "dof"}) {
    Json json = ToJson(WithBudgetAndVolume());
    json["parameters"][0][key] = -1;
    const auto after = CalibrationFromJson(json, "some.json");
    ASSERT_FALSE(after.ok()) << key;
    EXPECT_THAT(after.error().message, HasSubstr("u and U not below 0 and dof above 0 of M"));
  }
}

TEST(CalibrationJsonTest, AnUnreliableOneStaysUnreliable) {
  Calibration c = SomeCalibration();
  c.unreliable = {Sentence{"the grid minimum lies on the edge"}};
  const Json json = ToJson(c);
  EXPECT_EQ(json["status"], "unreliable");
  const auto after = CalibrationFromJson(json, "f");
  ASSERT_TRUE(after.ok());
  EXPECT_FALSE(after->ok());
}

TEST(CalibrationJsonTest, WhatIsSaidInOtherLanguages) {
  Calibration c = WithBudgetAndVolume();
  c.warnings = {Sentence{"one", "eins", "some.one"}, Sentence{"words of others"}, Sentence{"one", "eins", "some.one"}};
  c.unreliable = {Sentence{"two", "zwei", "some.two"}};
  c.budget[0].source = {"three", "drei", "some.three"};
  Comparison comparison;
  comparison.rows = {{{"four", "vier", "some.four"}, {}, {"five", "fünf", "some.five"}}};
  const Json json = ToJson(c), figures = FiguresToJson(c, comparison);
  EXPECT_EQ(json["warnings"], Json({"one", "words of others", "one"}));
  EXPECT_EQ(json["unreliable"], Json::array({"two"}));
  EXPECT_EQ(json["budget"][0]["source"], "three");
  EXPECT_EQ(figures["compare"][0]["method"], "four");
  EXPECT_EQ(figures["compare"][0]["note"], "five");
  EXPECT_EQ(json["messages"].size(), 3U);
  EXPECT_EQ(figures["messages"], Json::parse(R"([{"id": "some.two", "en": "two", "de": "zwei"},
                                              {"id": "some.one", "en": "one", "de": "eins"},
                                              {"id": "some.three", "en": "three", "de": "drei"},
                                              {"id": "some.four", "en": "four", "de": "vier"},
                                              {"id": "some.five", "en": "five", "de": "fünf"}])"));
}

TEST(CalibrationJsonTest, ResidualsAlongTheViews) {
  Calibration c = SomeCalibration();
  c.targets.emplace_back().name = "right";  // of which nothing is known
  const Json json = ToJson(c)["residuals"]["targets"];
  EXPECT_EQ(json[0]["name"], "left");
  EXPECT_EQ(json[0]["lags"], Json({0.0, 1.0, 2.0}));
  EXPECT_EQ(json[0]["correlation"], Json({1.0, 0.25, 0.0}));
  EXPECT_EQ(json[0]["correlation_length"], 1.5);
  EXPECT_EQ(json[0]["correlation_dies_out"], false);
  EXPECT_EQ(json[0]["histogram"]["from"], -8);
  EXPECT_EQ(json[0]["histogram"]["counts"], Json({1, 700, 0}));
  EXPECT_EQ(json[0]["histogram"]["below"], 2);
  EXPECT_EQ(json[0]["histogram"]["above"], 3);
  EXPECT_TRUE(json[1]["correlation_length"].is_null());
  EXPECT_TRUE(json[1]["lags"].empty());
}

TEST(CalibrationJsonTest, WhatIsNotFiniteIsNull) {
  Calibration c = SomeCalibration();
  c.parameters[0].u = std::numeric_limits<double>::infinity();
  c.parameters[0].k = std::numeric_limits<double>::quiet_NaN();
  c.covariance(0, 0) = std::numeric_limits<double>::infinity();
  c.condition = std::numeric_limits<double>::infinity();
  const Json json = ToJson(c);
  EXPECT_TRUE(json["parameters"][0]["u"].is_null());
  EXPECT_TRUE(json["parameters"][0]["k"].is_null());
  EXPECT_TRUE(json["covariance"][0][0].is_null());
  EXPECT_TRUE(json["condition"].is_null());
}

TEST(CalibrationJsonTest, WithoutAJackknifeThereIsNoUOfIt) {
  EXPECT_TRUE(ToJson(SomeCalibration())["parameters"][0]["u_jackknife"].is_null());
}

TEST(CalibrationJsonTest, AnOldFileLoadsForEver) {  // the specification's example of version 1
  const Json json = Json::parse(R"({"scancal": 1, "model": "turntable", "status": "ok", "warnings": [],
    "parameters": [{"name": "M", "unit": "mm", "role": "estimate", "value": 123.0021, "u": 0.011, "k": 2.04, "U": 0.022,
                    "dof": 31, "u_naive": 0.004, "u_clustered": 0.011, "u_jackknife": 0.02}],
    "covariance": [[1.2e-4, 0.0], [0.0, 1.1e-4]], "something new": {}})");
  const auto calibration = CalibrationFromJson(json, "f");
  ASSERT_TRUE(calibration.ok()) << calibration.error().message;
  EXPECT_EQ(calibration->Find("M")->value, 123.0021);
  EXPECT_TRUE(calibration->estimated.empty());
  EXPECT_TRUE(calibration->volume.rows.empty());
}

TEST(CalibrationJsonTest, OtherDocumentsAreErrorsNotCrashes) {
  for (const char* text :
       {"5", "[]", "null", "{}", R"({"scancal": "1"})", R"({"scancal": 2})", R"({"scancal": 1.5})", R"({"scancal": 1})",
        R"({"scancal": 1, "model": 5})", R"({"scancal": 1, "model": "turntable", "status": "ok"})",
        R"({"scancal": 1, "model": "turntable", "status": "ok", "parameters": {}})",
        R"({"scancal": 1, "model": "turntable", "status": "ok", "parameters": [5]})",
        R"({"scancal": 1, "model": "turntable", "status": "ok", "parameters": [{"name": "M"}]})",
        R"({"scancal": 1, "model": "turntable", "status": "ok", "parameters": [{"name": "M", "value": "1"}]})",
        R"({"scancal": 1, "model": "turntable", "status": 5, "parameters": []})",
        R"({"scancal": 1, "model": "turntable", "status": "ok", "parameters": [], "montecarlo": 5})",
        R"({"scancal": 1, "model": "turntable", "status": "ok", "parameters": [], "montecarlo": {"trials": "1"}})",
        R"({"scancal": 1, "model": "turntable", "status": "ok", "parameters": [], "montecarlo": {"trials": 1}})"}) {
    const auto calibration = CalibrationFromJson(Json::parse(text), "some.json");
    ASSERT_FALSE(calibration.ok()) << text;
    EXPECT_THAT(calibration.error().message, AllOf(StartsWith("some.json: expected "), HasSubstr("calibration.json?")))
        << text;
  }
}

TEST(CalibrationJsonTest, TheMonteCarloIsEmptyOrWhole) {
  Calibration c = SomeCalibration();
  EXPECT_EQ(ToJson(c)["montecarlo"], Json::object());
  c.monte_carlo = SomeMonteCarlo();
  const Json json = Json::parse(ToJson(c).dump())["montecarlo"];
  EXPECT_EQ(json["trials"], 10'000);
  EXPECT_EQ(json["failed"], 3);
  EXPECT_EQ(json["seed"], c.monte_carlo.seed);
  EXPECT_EQ(json["digits"], 1);
  EXPECT_EQ(json["stable"], true);
  const Json& m = json["parameters"][0];
  EXPECT_EQ(m["name"], "M");
  EXPECT_EQ(m["mean"], 123.0023);
  EXPECT_EQ(m["u"], 0.0112);
  EXPECT_EQ(m["low"], 122.9801);
  EXPECT_EQ(m["high"], 123.0239);
  EXPECT_EQ(m["gum_low"], 122.9801);
  EXPECT_EQ(m["gum_high"], 123.0241);
  EXPECT_EQ(m["tolerance"], 5e-3);
  EXPECT_EQ(m["verdict"], "PASS");
  EXPECT_EQ(m["histogram"]["edges"], Json({122.0, 123.0, 124.0}));
  EXPECT_EQ(m["histogram"]["counts"], Json({4000, 5997}));
  EXPECT_TRUE(json["parameters"][1]["gum_high"].is_null());

  const auto back = CalibrationFromJson(Json::parse(ToJson(c).dump()), "f");
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back->monte_carlo.seed, c.monte_carlo.seed);
  ASSERT_EQ(back->monte_carlo.parameters.size(), 2u);
  EXPECT_EQ(back->monte_carlo.parameters[0].high, 123.0239);
  EXPECT_EQ(back->monte_carlo.parameters[0].verdict, "PASS");
  EXPECT_EQ(back->monte_carlo.parameters[0].edges, c.monte_carlo.parameters[0].edges);
  EXPECT_EQ(back->monte_carlo.parameters[0].counts, c.monte_carlo.parameters[0].counts);
  EXPECT_TRUE(std::isnan(back->monte_carlo.parameters[1].gum_high));
  c.monte_carlo = {};
  EXPECT_EQ(CalibrationFromJson(ToJson(c), "f")->monte_carlo.trials, 0);
}

}  // namespace
}  // namespace scancal
