#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include "report/calibration_json.h"

namespace scancal {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

NumberTable SomeTable() {
  return {{"alpha", "u"}, {Unit::kRad, Unit::kMm}, {{0.1 + 0.2, kNotANumber}, {1e-300, INFINITY}}, {}};
}

Calibration WithFigures() {
  Calibration c;
  c.model = "turntable";
  c.parameters.resize(3);
  for (size_t k = 0; k < 3; ++k) c.parameters[k].name = std::string("a_") + "123"[k];
  c.parameters[0].role = Role::kEstimate;
  c.parameters[0].nominal = 560;
  c.parameters[0].prior = 0.25;
  c.parameters[0].prior_u = 0.5;
  c.parameters[0].dof = 10;
  c.parameters[1].role = Role::kEstimate;
  c.parameters[1].dof = 10;
  c.influences = {{"noise_y", Unit::kMm, Scope::kPoint, Role::kEstimate, 0.05},
                  {"tilt_x", Unit::kRad, Scope::kSystem, Role::kHold, 0}};
  c.check = {{Sentence{"1 to 2"}, Sentence{"1 to 3"}}, {0.5, -1}, {0.1, 0.2}, {0.001, 0}};
  c.surface = {{"near", SomeTable()}, {"search", SomeTable()}};
  c.targets.resize(2);
  c.targets[0].name = "left";
  c.targets[0].residual_tables = {{"cells", SomeTable()}};
  c.targets[0].scene = {{"outline", SomeTable()}};
  c.targets[0].scene["outline"].names = {"A \"quoted\"", "<script>"};
  c.targets[1].name = "right";
  return c;
}

TEST(FiguresJsonTest, TablesKeepEveryDigitAndNoNumberIsNull) {
  const Json json = Json::parse(ToJson(WithFigures()).dump(2));
  EXPECT_EQ(json["surface"]["near"]["columns"], Json({"alpha", "u"}));
  EXPECT_EQ(json["surface"]["near"]["units"], Json({"rad", "mm"}));
  EXPECT_EQ(json["surface"]["near"]["rows"][0][0].get<double>(), 0.1 + 0.2);
  EXPECT_TRUE(json["surface"]["near"]["rows"][0][1].is_null());
  EXPECT_TRUE(json["surface"]["near"]["rows"][1][1].is_null());
  EXPECT_EQ(json["surface"]["search"], json["surface"]["near"]);
  EXPECT_FALSE(json["surface"]["near"].contains("names"));
}

TEST(FiguresJsonTest, TablesOfTargetsStandBesideTheirNames) {
  const Json json = ToJson(WithFigures());
  const Json& residuals = json["residuals"]["targets"];
  EXPECT_EQ(residuals[0]["name"], "left");
  EXPECT_EQ(residuals[0]["cells"], json["surface"]["near"]);
  EXPECT_FALSE(residuals[1].contains("cells"));
  ASSERT_EQ(json["scene"]["targets"].size(), 1U);
  EXPECT_EQ(json["scene"]["targets"][0]["name"], "left");
  EXPECT_EQ(json["scene"]["targets"][0]["outline"]["names"], Json({"A \"quoted\"", "<script>"}));
  EXPECT_EQ(ToJson(Calibration())["scene"], Json::object());
  EXPECT_EQ(ToJson(Calibration())["surface"], Json::object());
  EXPECT_EQ(ToJson(Calibration())["volume"], Json::object());
}

TEST(FiguresJsonTest, WhatWasKnownBefore) {
  const Json json = ToJson(WithFigures());
  EXPECT_EQ(json["parameters"][0]["nominal"], 560);
  EXPECT_EQ(json["parameters"][0]["prior"], 0.25);
  EXPECT_EQ(json["parameters"][0]["prior_u"], 0.5);
  for (const char* key : {"nominal", "prior", "prior_u"})
    for (const size_t k : {1, 2}) EXPECT_FALSE(json["parameters"][k].contains(key)) << key;
  EXPECT_EQ(json["check"]["u"], Json::parse("[0.001, null]"));
  EXPECT_EQ(json["influences"], Json::parse(R"([
      {"source": "noise_y", "role": "estimate", "u": 0.05, "unit": "mm", "scope": "point"},
      {"source": "tilt_x", "role": "hold", "u": 0, "unit": "rad", "scope": "system"}])"));
}

TEST(FiguresJsonTest, AComparisonWithoutItsComputingTimes) {
  const Comparison comparison = {{{"M/mm", 6}, {"seconds", 2, true}, {"S/um"}},
                                 {{{"grid"}, {{123.0, 0}, {0.7, 0}, {std::nullopt, 0}}, {"minimum on the edge"}},
                                  {{"joint"}, {{123.4, 0.1}, {0.1, 0}, {INFINITY, 0}}, {}},
                                  {{"none"}, {}, {"left out"}}}};
  EXPECT_EQ(FiguresToJson(Calibration(), comparison)["compare"], Json::parse(R"([
      {"method": "grid", "note": "minimum on the edge",
       "cells": [{"column": "M/mm", "value": 123.0, "u": null}, {"column": "S/um", "value": null, "u": null}]},
      {"method": "joint", "note": "",
       "cells": [{"column": "M/mm", "value": 123.4, "u": 0.1}, {"column": "S/um", "value": null, "u": null}]},
      {"method": "none", "note": "left out", "cells": []}])"));
}

TEST(FiguresJsonTest, ALaterCommandDoesNotLookAtThem) {
  Json json = ToJson(WithFigures());
  for (const char* key : {"compare", "surface", "scene", "residuals", "influences", "certificate", "check"})
    json[key] = Json::parse(R"([{"something": "else"}, 5])");
  for (const char* key : {"nominal", "prior", "prior_u"}) json["parameters"][0][key] = "text";
  const auto calibration = CalibrationFromJson(json, "f");
  ASSERT_TRUE(calibration.ok()) << calibration.error().message;
  EXPECT_EQ(calibration->parameters.size(), 3U);
  EXPECT_TRUE(calibration->targets.empty());
}

}  // namespace
}  // namespace scancal
