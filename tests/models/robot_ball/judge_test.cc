// What a robot's calibration says of data that cannot be right.
#include "models/robot_ball/judge.h"
#include <gmock/gmock.h>
#include <functional>
#include <numbers>
#include <tuple>
#include "io/units.h"
#include "models/robot_ball/published.h"
#include "models/robot_ball/simulate.h"
#include "models/robot_ball/start.h"

namespace scancal::robot_ball {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

template <class Matcher>
auto Says(const Matcher& matcher) {
  return Field(&Sentence::english, matcher);
}

// As the program calibrates; what is checked, against `before`.
Calibration Calibrated(const Measurements& data, const std::vector<double>& before, Model model) {
  const Result<ScreenedFit> fitted = FitScreened(data, model);
  EXPECT_TRUE(fitted.ok()) << fitted.error().message;
  Calibration calibration = Summarize(fitted->fit.solution, {});
  calibration.warnings.insert(calibration.warnings.end(), fitted->warnings.begin(), fitted->warnings.end());
  calibration.check.before = before;
  calibration.check.after = SpacingErrors(data, fitted->fit.Found());
  for (const CheckLength& length : data.check) calibration.check.names.push_back({length.name});
  Judge(*fitted, &calibration);
  return calibration;
}

Calibration Calibrated(const Measurements& data, const std::vector<double>& before) {
  Model model(data.links, data.spheres);
  for (int k = model.FirstOfSpheres(); k < std::ssize(model.quantities()); ++k) {
    model.quantity(k).role = Role::kConsider;
    model.quantity(k).u = data.u_spheres;
  }
  return Calibrated(data, before, std::move(model));
}

std::vector<Sentence> Doubts(const Measurements& data, const std::vector<double>& before) {
  return Calibrated(data, before).unreliable;
}

Measurements FromSeed(uint64_t seed) {
  Scene scene;
  scene.seed = scene.noise_seed = seed;
  return Simulate(scene).data;
}

TEST(RobotVerdicts, RightDataRaiseNone) {
  for (uint64_t seed = 1; seed <= 8; ++seed) EXPECT_THAT(Doubts(FromSeed(seed), std::vector(10, 1.0)), IsEmpty());
}

TEST(RobotVerdicts, APoseWithAWrongJointAngleIsSetAsideByItsName) {
  const Measurements right = FromSeed(1);
  Measurements without = right;
  std::vector<Model::View>& views = without.stations[3].views;
  views.erase(views.begin() + 2);
  const Calibration expected = Calibrated(without, std::vector(10, 100.0));
  for (const double degrees : {1.0, 10.0, 40.0}) {
    Measurements data = right;
    Model::View& pose = data.stations[3].views[2];
    pose.joints[2] += degrees * kDegree;
    SetTerms(&data);
    const Calibration found = Calibrated(data, std::vector(10, 100.0));
    EXPECT_THAT(found.unreliable, IsEmpty());
    EXPECT_THAT(found.warnings, Contains(Says(HasSubstr(pose.name))));
    for (const std::string& name : expected.estimated)
      EXPECT_NEAR(found.Find(name)->value, expected.Find(name)->value, 0.02 * expected.Find(name)->u) << name;
  }
}

TEST(RobotVerdicts, ManyPosesThatContradictAreNoException) {
  Measurements data = FromSeed(1);
  for (Station& station : data.stations) station.views[1].joints[4] += 2 * kDegree;
  EXPECT_THAT(Doubts(data, std::vector(10, 100.0)), Contains(Says(HasSubstr("no exception"))));
}

TEST(RobotVerdicts, ExchangedObservationsAndAnotherStationAreNamed) {
  Measurements data = FromSeed(1);
  std::swap(data.stations[2].views[1].balls, data.stations[2].views[5].balls);
  Result<Screened> screened = Screen(data);
  ASSERT_TRUE(screened.ok()) << screened.error().message;
  ASSERT_EQ(screened->warnings.size(), 1);
  EXPECT_THAT(screened->warnings[0].english,
              HasSubstr("are its observations and those of " + data.stations[2].views[5].name + " exchanged?"));
  EXPECT_EQ(screened->data.stations[2].views.size(), data.stations[2].views.size() - 2);

  data = FromSeed(2);
  data.stations[5].views.push_back(data.stations[1].views[3]);
  data.stations[1].views.erase(data.stations[1].views.begin() + 3);
  screened = Screen(data);
  ASSERT_TRUE(screened.ok()) << screened.error().message;
  ASSERT_EQ(screened->warnings.size(), 1);
  EXPECT_THAT(screened->warnings[0].english, HasSubstr("it fits station " + data.stations[1].name));
}

// What people do wrong is done to right data; the refusal says it.
TEST(RobotVerdicts, UsualMistakesOfJointsAreNamed) {
  const auto refusal = [](const Measurements& data) {
    const Result<Screened> screened = Screen(data);
    return screened.ok() ? "not refused" : screened.error().message;
  };
  const auto with = [](uint64_t seed, const std::function<void(Model::View&)>& change) {
    Measurements data = FromSeed(seed);
    for (Station& station : data.stations)
      for (Model::View& view : station.views) change(view);
    return data;
  };
  for (const int sign : {-1, 1})
    EXPECT_THAT(refusal(with(3, [=](auto& view) { view.joints[2] += sign * view.joints[1]; })),
                HasSubstr(sign > 0 ? "coupled: {q3: q3 - q2}" : "coupled: {q3: q3 + q2}"));
  for (size_t j = 1; j < 6; ++j)
    EXPECT_THAT(refusal(with(j, [=](auto& view) { view.joints[j] *= -1; })),
                HasSubstr("q" + std::to_string(j + 1) + " turns the other way"));
  EXPECT_THAT(refusal(with(1, [](auto& view) { view.joints[3] += std::numbers::pi / 2; })),
              HasSubstr("q4 is zero elsewhere, -90 deg away"));
  Measurements late = FromSeed(4);
  for (Station& station : late.stations)
    for (size_t v = station.views.size(); v-- > 1;) station.views[v].balls = station.views[v - 1].balls;
  EXPECT_THAT(refusal(late), HasSubstr("one pose late"));
}

TEST(RobotVerdicts, UsualMistakesOfFlangesAreNamed) {
  const auto refusal = [](const std::function<void(Eigen::Isometry3d&)>& change) {
    const Measurements of_joints = FromSeed(1);
    Measurements data = of_joints;
    data.links.clear();
    data.check.clear();
    for (Station& station : data.stations)
      for (Model::View& view : station.views) {
        view.base_from_flange = BaseFromFlange(of_joints.links, view.joints);
        view.joints.clear();
        view.terms.clear();
        change(view.base_from_flange);
      }
    const Result<Screened> screened = Screen(data);
    return screened.ok() ? "not refused" : screened.error().message;
  };
  EXPECT_EQ(refusal([](auto&) {}), "not refused");
  EXPECT_THAT(refusal([](auto& pose) {
                const Eigen::Quaterniond q(pose.linear());
                pose.linear() = Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
              }),
              HasSubstr("w first"));
  EXPECT_THAT(refusal([](auto& pose) { pose.linear().transposeInPlace(); }), HasSubstr("inverse turn"));
  EXPECT_THAT(refusal([](auto& pose) { pose = pose.inverse(); }), HasSubstr("base in the flange"));
}

TEST(RobotVerdicts, CopiesCountOnceAndAreNamed) {
  const Measurements data = FromSeed(1);
  for (const double rounding : {0.0, 1e-6, 1e-3}) {
    Measurements twice = data;
    Station again = data.stations[2];
    again.name = "again";
    int number = 1000;
    for (Model::View& view : again.views) {
      view.name += "b";
      view.number = number++;
      for (Model::SeenBall& ball : view.balls)
        if (rounding > 0) ball.centre = (ball.centre / rounding).array().round() * rounding;
    }
    twice.stations.push_back(again);
    std::vector<Sentence> warnings;
    DropCopies("poses.csv", &twice, &warnings);
    ASSERT_EQ(warnings.size(), 1) << rounding;
    EXPECT_THAT(warnings[0].english, HasSubstr("3-1b of 3-1, 3-2b of 3-2"));
    EXPECT_EQ(twice.stations.size(), data.stations.size());
  }
}

// The robot returns to a pose, and a scanner with coarse steps shows the same numbers: that is honest.
TEST(RobotVerdicts, HonestRepetitionsAreNoCopies) {
  Scene scene;
  for (const double step : {1e-6, 0.05, 0.2}) {
    Measurements data = FromSeed(1);
    scene.noise_seed = 2;
    const Measurements again = Simulate(scene).data;
    for (size_t t = 0; t < data.stations.size(); ++t)
      for (const Model::View& view : again.stations[t].views) data.stations[t].views.push_back(view);
    size_t poses = 0;
    for (Station& station : data.stations)
      for (Model::View& view : station.views) {
        ++poses;
        for (Model::SeenBall& ball : view.balls) ball.centre = (ball.centre / step).array().round() * step;
      }
    std::vector<Sentence> warnings;
    DropCopies("poses.csv", &data, &warnings);
    EXPECT_THAT(warnings, IsEmpty()) << step;
    size_t left = 0;
    for (const Station& station : data.stations) left += station.views.size();
    EXPECT_EQ(left, poses);
  }
}

// One thing of the robot is not as the model has it; what it is is named, and estimating it brings the truth back.
TEST(RobotVerdicts, WhatTheJointsDoIsNamedAndCanBeEstimated) {
  Quantities terms;
  DeclareJointTerms(6, &terms);
  const std::tuple<const char*, double, const char*> kCases[] = {{"gravity_2_4", 1.5e-3, "gravity_2"},
                                                                 {"backlash_3", 3e-4, "backlash_3"},
                                                                 {"joint_scale_2", 1e-3, "joint_scale_2"},
                                                                 {"eccentricity_sin1_4", 6e-4, "eccentricity_4"},
                                                                 {"eccentricity_cos2_3", 5e-4, "eccentricity_3"}};
  for (const auto& [name, size, source] : kCases) {
    Scene scene;
    scene.joint_terms.assign(terms.size(), 0);
    const auto index = static_cast<size_t>(Find(terms, name));
    scene.joint_terms[index] = size;
    scene.poses = 12;
    const Measurements data = Simulate(scene).data;
    const std::vector<Sentence> doubts = Doubts(data, std::vector(10, 1.0));
    EXPECT_THAT(doubts, Contains(Says(AllOf(HasSubstr("lack of fit"), HasSubstr(source))))) << name;
    Model model(data.links, data.spheres);
    Quantity& quantity = model.quantity(model.FirstOfJointTerms() + static_cast<int>(index));
    quantity.role = Role::kEstimate;
    const Calibration found = Calibrated(data, std::vector(10, 1.0), model);
    EXPECT_THAT(found.unreliable, IsEmpty()) << name;
    EXPECT_NEAR(found.Find(name)->value, size, 2 * found.Find(name)->U) << name;
    EXPECT_LT(found.Find(name)->U, size / 2) << name;
  }
}

// As a robot of these numbers would have seen the same balls, with the noise of `data`.
void SeeAgain(const Simulated& robot, const Kinematics& truth, Measurements* data) {
  for (size_t s = 0; s < data->stations.size(); ++s)
    for (Model::View& view : data->stations[s].views) {
      const Eigen::Isometry3d before = BaseFromScanner(robot.data, robot.truth, view),
                              now = BaseFromScanner(*data, truth, view);
      for (Model::SeenBall& ball : view.balls) {
        const Eigen::Vector3d k =
            robot.base_from_artifact[s] * PublishedArtifact()[static_cast<size_t>(ball.sphere)].centre;
        ball.centre += now.inverse() * k - before.inverse() * k;
      }
    }
}

TEST(RobotVerdicts, AMotorThatIsNotRoundIsNamedAndCanBeEstimated) {
  Scene scene;
  scene.poses = 12;
  const Simulated robot = Simulate(scene);
  Measurements data = robot.data;
  data.gear_ratios = {121, 160.6, 101, 99.8, 80.7, 51};
  SetTerms(&data);
  Quantities terms;
  DeclareJointTerms(6, &terms);
  Kinematics truth = robot.truth;
  truth.joint_terms.assign(terms.size(), 0);
  const auto index = static_cast<size_t>(Find(terms, "motor_sin_3"));
  truth.joint_terms[index] = 5e-4;
  SeeAgain(robot, truth, &data);
  data.check.clear();  // the robot before had seen them
  EXPECT_THAT(Doubts(data, {}), Contains(Says(AllOf(HasSubstr("lack of fit"), HasSubstr("motor_3")))));
  Model model(data.links, data.spheres);
  for (const int k : {0, -1})
    model.quantity(model.FirstOfJointTerms() + static_cast<int>(index) + k).role = Role::kEstimate;
  const Calibration found = Calibrated(data, {}, model);
  EXPECT_THAT(found.unreliable, IsEmpty());
  EXPECT_NEAR(found.Find("motor_sin_3")->value, 5e-4, 2 * found.Find("motor_sin_3")->U);
  EXPECT_LT(found.Find("motor_sin_3")->U, 1e-4);
}

// Links of aluminium in a hall that warms up by 12 K.
TEST(RobotVerdicts, LinksThatGrowWithTemperatureAreNamedAndEstimatedOrInTheBudget) {
  Scene scene;
  scene.poses = 12;
  const Simulated robot = Simulate(scene);
  Measurements data = robot.data;
  data.temperature = 22;
  for (Station& station : data.stations)
    for (Model::View& view : station.views) view.warmer = 6 * std::sin(0.7 * view.number);
  Kinematics truth = robot.truth;
  truth.expansion = 2.3e-5;
  SeeAgain(robot, truth, &data);
  EXPECT_THAT(Doubts(data, std::vector(10, 1.0)),
              Contains(Says(AllOf(HasSubstr("lack of fit"), HasSubstr("expansion")))));
  Model model(data.links, data.spheres);
  model.quantity(Model::kExpansion).role = Role::kEstimate;
  const Calibration found = Calibrated(data, std::vector(10, 1.0), model);
  EXPECT_THAT(found.unreliable, IsEmpty());
  EXPECT_NEAR(found.Find("expansion")->value, 2.3e-5, 2 * found.Find("expansion")->U);
  EXPECT_LT(found.Find("expansion")->U, 1e-5);
  model.quantity(Model::kExpansion).role = Role::kConsider;
  model.quantity(Model::kExpansion).value = 2.3e-5;
  model.quantity(Model::kExpansion).u = 1e-5;
  const Calibration considered = Calibrated(data, std::vector(10, 1.0), model);
  EXPECT_THAT(considered.unreliable, IsEmpty());
  double share = 0;
  for (const BudgetLine& line : considered.budget)
    if (line.source.english == "expansion") share = *std::max_element(line.share.begin(), line.share.end());
  EXPECT_GT(share, 0.01);
}

TEST(RobotVerdicts, AScannerThatSlippedIsNamedWithThePose) {
  Measurements data = FromSeed(1);
  const Eigen::Isometry3d slip(Eigen::Translation3d(0.2, 0, 0.3));
  for (Station& station : data.stations)
    for (Model::View& view : station.views)
      if (view.number >= 31)
        for (Model::SeenBall& ball : view.balls) ball.centre = slip * ball.centre;
  std::string name;
  for (const Station& station : data.stations)
    for (const Model::View& view : station.views)
      if (view.number == 31) name = view.name;
  EXPECT_THAT(Doubts(data, std::vector(10, 1.0)),
              Contains(Says(HasSubstr("the scanner on its flange stands elsewhere from pose " + name))));
}

TEST(RobotVerdicts, AnArtifactThatWasPushedIsNamedWithThePose) {
  Measurements data = FromSeed(1);
  std::vector<Model::View>& views = data.stations[4].views;
  const Eigen::Isometry3d push(Eigen::Translation3d(0.4, -0.3, 0.2));
  for (size_t v = 4; v < views.size(); ++v) {
    const Eigen::Isometry3d base_from_tool = BaseFromScanner(data, {DrawnHandEye(), {}}, views[v]);
    for (Model::SeenBall& ball : views[v].balls)
      ball.centre = base_from_tool.inverse() * (push * (base_from_tool * ball.centre));
  }
  EXPECT_THAT(Doubts(data, std::vector(10, 1.0)),
              Contains(Says(HasSubstr("the artifact (or the base) stands elsewhere from pose " + views[4].name))));
}

// A hand-eye near half a turn about any axis: its vector is never longer than pi, whatever side the fit comes from.
TEST(RobotFit, RotationVectorsAreCanonical) {
  for (int octant = 0; octant < 8; ++octant) {
    for (const double beyond : {-1e-3, 0.0, 1e-3}) {
      Scene scene;
      scene.stations = 3;
      scene.check_positions = 0;
      const Eigen::Vector3d axis =
          Eigen::Vector3d(octant & 1 ? -1 : 1, octant & 2 ? -0.5 : 0.5, octant & 4 ? -0.2 : 0.2).normalized();
      Measurements data = Simulate(scene).data;
      // The scanner's frame turned at will: the same rig, told otherwise.
      const Eigen::Isometry3d now = PublishedHandEye();
      Eigen::Isometry3d wanted = now;
      wanted.linear() = Eigen::AngleAxisd(std::numbers::pi + beyond, axis).toRotationMatrix();
      const Eigen::Isometry3d change = wanted.inverse() * now;
      for (Station& station : data.stations)
        for (Model::View& view : station.views)
          for (Model::SeenBall& ball : view.balls) ball.centre = change * ball.centre;
      // From a start told by the longer vector.
      const Result<JointFit> fit = FitJointly(data, Model(data.links, data.spheres), wanted);
      ASSERT_TRUE(fit.ok()) << fit.error().message;
      const std::vector<double> values = Values(fit->solution.problem, fit->solution.fit.estimate, 0);
      EXPECT_LE(Eigen::Vector3d::Map(&values[Model::kHandEye + 3]).norm(), std::numbers::pi + 1e-12);
      EXPECT_TRUE(fit->Found().flange_from_scanner.linear().isApprox(wanted.linear(), 1e-3)) << octant << " " << beyond;
    }
  }
}

TEST(RobotVerdicts, LengthsThatBecomeWorseOrHaveAnotherUnitAreTold) {
  Measurements data = FromSeed(1);
  EXPECT_THAT(Doubts(data, std::vector(10, 0.001)), Contains(Says(HasSubstr("more than with the nominal robot"))));
  data.check[2].distance /= 1000;
  EXPECT_THAT(Doubts(data, std::vector(10, 1.0)),
              Contains(Says(AllOf(HasSubstr(data.check[2].name), HasSubstr("another unit")))));
}

}  // namespace
}  // namespace scancal::robot_ball
