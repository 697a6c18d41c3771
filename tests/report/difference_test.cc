#include "report/difference.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include "report/calibration_json.h"
#include "tests/report/some_calibration.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// Of the same instrument, from measurements of its own.
Json Earlier() {
  Calibration c = SomeCalibration();
  c.inputs = {{"left.csv", "of another day"}, {"dataset.yaml", "d"}};
  return ToJson(c);
}
Json Later() {
  Calibration c = WithBudgetAndVolume();
  c.inputs = {{"left.csv", "abc"}, {"dataset.yaml", "d"}};
  return ToJson(c);
}
std::string Doubts(const Json& before, const Json& after) {
  std::string ids;
  for (const Sentence& doubt : DoubtsAbout(before, after)) {
    EXPECT_FALSE(doubt.german.empty());
    ids += (ids.empty() ? "" : " ") + doubt.id.substr(std::string("report.").size());
  }
  return ids;
}

TEST(DoubtsAbout, NoneAboutTwoGoodOnes) {
  Json later = Later();
  later["command"] = "another";
  EXPECT_EQ(Doubts(Earlier(), later), "");
  EXPECT_EQ(Doubts(Later(), Later()), "same_file common_inputs");
  later["certificate"] = {{"item", {{"identifications", {{{"issuer", "m"}, {"value", "7"}}}}}}};
  EXPECT_EQ(Doubts(Earlier(), later), "item_of_one");  // nobody knows that it is the same
  EXPECT_THAT(DoubtsAbout(Earlier(), later)[0].english, HasSubstr("(7)"));
  Json earlier = Earlier();
  for (const Json& nothing : {Json("none"), Json::object(), Json{{"item", {{"name", "x"}}}},
                              Json{{"item", {{"identifications", {{{"value", nullptr}}}}}}}}) {
    earlier["certificate"] = nothing;
    EXPECT_EQ(Doubts(earlier, later), "item_of_one") << nothing;
  }
  earlier["certificate"] = later["certificate"];
  EXPECT_EQ(Doubts(earlier, later), "");
  earlier["certificate"] = {{"item", {{"identifications", {{{"issuer", "m"}, {"value", 8}}}}}}};
  EXPECT_EQ(Doubts(earlier, later), "other_items");
}

TEST(DoubtsAbout, CommonMeasurementsByContent) {
  Json earlier = Earlier();
  earlier["inputs"][0] = {{"file", "old name.csv"}, {"sha256", "abc"}};
  ASSERT_EQ(Doubts(earlier, Later()), "common_inputs");
  EXPECT_THAT(DoubtsAbout(earlier, Later())[0].english, HasSubstr("(left.csv)"));
  Json many = Later();
  for (int k = 0; k < 20; ++k) many["inputs"].push_back({{"file", std::to_string(k) + ".csv"}, {"sha256", "abc"}});
  EXPECT_THAT(DoubtsAbout(earlier, many)[0].english, HasSubstr("6.csv + 13)"));
}

TEST(DoubtsAbout, WhatIsCommonAndCannotBeCountedOnce) {
  Json earlier = Later(), later = Later();
  earlier["inputs"] = Json::array();
  EXPECT_EQ(Doubts(earlier, later), "");  // tilt_x: a number of the system, counted once
  for (Json* file : {&earlier, &later})
    (*file)["budget"].push_back({{"source", "form"}, {"type", "B"}, {"sensitivity", Json::object()}});
  EXPECT_EQ(Doubts(earlier, later), "common_influences");
  later["influences"] = {{{"source", "form"}, {"scope", "point"}}};  // declared noise is drawn anew
  EXPECT_EQ(Doubts(earlier, later), "");
}

TEST(DoubtsAbout, OtherModelsRolesNumbersAndUnreliableOnes) {
  Json earlier = Earlier();
  earlier["model"] = "robot-ball";
  earlier["residual"] = "ball";
  earlier["status"] = "unreliable";
  EXPECT_EQ(Doubts(earlier, Later()), "other_models other_residuals earlier_unreliable");
  Json later = Later();
  later["status"] = "unreliable";
  EXPECT_EQ(Doubts(Earlier(), later), "later_unreliable");
  earlier = Earlier();
  earlier["parameters"][1]["role"] = "hold";
  EXPECT_EQ(Doubts(earlier, Later()), "other_roles");
  earlier = Earlier();
  earlier["parameters"][3]["value"] = 0.001;
  EXPECT_EQ(Doubts(earlier, Later()), "held_elsewhere");
  EXPECT_THAT(DoubtsAbout(earlier, Later())[0].english, HasSubstr("tilt_y"));
  earlier["parameters"][3]["role"] = "consider";  // and there: the value says more
  EXPECT_EQ(Doubts(earlier, Later()), "held_elsewhere");
  earlier["parameters"][3]["value"] = nullptr;  // at 0, as the other one says in a number
  EXPECT_EQ(Doubts(earlier, Later()), "considered_in_one");
  earlier["parameters"][3]["role"] = "hold";
  EXPECT_EQ(Doubts(earlier, Later()), "");
  earlier = Earlier();
  earlier["parameters"].erase(3);
  EXPECT_EQ(Doubts(earlier, Later()), "missing_parameters");
  earlier = Earlier();
  earlier["parameters"][0]["nominal"] = 120;
  EXPECT_EQ(Doubts(earlier, Later()), "other_nominals");
}

TEST(DifferenceText, SaysWhatChangedAndWhetherItMatters) {
  const Calibration then = SomeCalibration();
  Calibration now = SomeCalibration();
  CalibrationDifference difference = DifferenceOf(SeriesOf(std::vector{then, now}, {}));
  EXPECT_THAT(Verdict(difference), HasSubstr("agree"));
  now.parameters[1].value += 0.2;
  difference = DifferenceOf(SeriesOf(std::vector{then, now}, {}));
  const Shift shift{125, 0.01, 0.02, 0.1, "y = 3 mm"};
  EXPECT_THAT(ToText(difference, then, now, shift),
              AllOf(HasSubstr("N  409.100(20)  409.300(20)    mm  0.200(28)"), HasSubstr("3.56"),
                    HasSubstr("0.010 mm rms, at most 0.020 mm (at y = 3 mm; U of both there: 0.10 mm)")));
  EXPECT_THAT(Verdict(difference), AllOf(HasSubstr("differ"), HasSubstr("N, by 0.200(28) mm")));
  EXPECT_EQ(ToJson(difference, {})["changes"][1]["name"], "N");
  EXPECT_TRUE(ToJson(difference, {})["significant"]);
}

TEST(HistoryText, TellsAlarmsAndGivesEveryPoint) {
  std::vector<Calibration> all(5, SomeCalibration());
  all[4].parameters[0].value += 0.2;
  History history{{"a", "b", "c", "d", "e,1"}, {0, 10, 20, 30, 40}, "day", {}, {}};
  history.charts = ChartsOf(SeriesOf(all, {}), history.times);
  const auto alarms = AlarmsOf(history);
  ASSERT_GE(alarms.size(), 5U);  // one so far off takes the centre along: 0.04 from the others, u = 0.011 sqrt(4 / 5)
  EXPECT_EQ(alarms[0], "M: a lies -4.1 u from the centre, beyond the limits");
  EXPECT_EQ(alarms[4], "M: e,1 lies +16.3 u from the centre, beyond the limits");
  EXPECT_THAT(ToText(history), AllOf(HasSubstr("drift a day"), HasSubstr("beyond the limits"), HasSubstr("CUSUM")));
  const std::string csv = ToCsv(history);
  EXPECT_THAT(csv, HasSubstr("parameter,unit,calibration,day,value,u,U,"));
  EXPECT_THAT(csv, HasSubstr("\nM,mm,\"e,1\",40,123.2021,0.011,"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 11);
  EXPECT_EQ(ToJson(history)["charts"][0]["points"].size(), 5U);
}

TEST(ShiftOf, IsTheLargestAndTheRms) {
  Propagation a{
      {"alpha", "y"}, {Unit::kRad, Unit::kMm}, {{{0.1, 5}, {1, 2, 3}, {}}, {{0.2, 6}, {1, 2, 3}, {}}}, {}, {}, {}};
  a.points[1].uncertainty.U_max = 0.3;
  Propagation b = a;
  b.points[1].position += Eigen::Vector3d(0, 3, 4);
  b.points[1].uncertainty.U_max = 0.4;
  const Shift shift = ShiftOf(a, b);
  EXPECT_NEAR(shift.largest, 5, 1e-12);
  EXPECT_NEAR(shift.rms, 5 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(shift.U_there, 0.5, 1e-12);
  EXPECT_THAT(shift.where, AllOf(HasSubstr("alpha = 11.5 deg"), HasSubstr("y = 6.00 mm")));
}

}  // namespace
}  // namespace scancal
