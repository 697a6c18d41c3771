// What a robot's calibration says of data that cannot be right.
#include <gmock/gmock.h>
#include "io/units.h"
#include "models/robot_ball/hand_eye.h"
#include "models/robot_ball/simulate.h"
#include "models/robot_ball/spacing.h"
#include "models/robot_ball/verdicts.h"

namespace scancal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// The doubts about these data, checked against `before`.
std::vector<std::string> Doubts(const RobotData& data, const std::vector<double>& before) {
  const Result<RobotSetup> start = InitialHandEye(data);
  const Result<RobotFit> fit = FitRobot(data, RobotBall(data.links, data.spheres), start->flange_from_scanner);
  EXPECT_TRUE(fit.ok()) << fit.error().message;
  Calibration calibration;
  calibration.check.before = before;
  calibration.check.after = SpacingErrors(data, fit->Setup());
  for (const CheckLength& length : data.check) calibration.check.names.push_back(length.name);
  JudgeRobot(data, *fit, &calibration);
  return calibration.unreliable;
}

RobotData Simulated(uint64_t seed) {
  RobotScene scene;
  scene.seed = scene.noise_seed = seed;
  return SimulateRobot(scene).data;
}

TEST(RobotVerdicts, RightDataRaiseNone) {
  for (uint64_t seed = 1; seed <= 8; ++seed) EXPECT_THAT(Doubts(Simulated(seed), std::vector(10, 1.0)), IsEmpty());
}

TEST(RobotVerdicts, AWrongJointAngleIsFoundByItsPose) {
  for (const double degrees : {1.0, 10.0}) {
    RobotData data = Simulated(1);
    RobotBall::View& pose = data.stations[3].views[2];
    pose.joints[2] += degrees * kDegree;
    EXPECT_THAT(
        Doubts(data, std::vector(10, 100.0)),
        ElementsAre(HasSubstr("pose " + pose.name + " of station " + data.stations[3].name + ": its balls lie")));
  }
}

TEST(RobotVerdicts, LengthsThatBecomeWorseOrHaveAnotherUnitAreTold) {
  RobotData data = Simulated(1);
  EXPECT_THAT(Doubts(data, std::vector(10, 0.001)), ElementsAre(HasSubstr("more than with the nominal robot")));
  data.check[2].distance /= 1000;
  EXPECT_THAT(Doubts(data, std::vector(10, 1.0)),
              ElementsAre(testing::AllOf(HasSubstr(data.check[2].name), HasSubstr("another unit"))));
}

}  // namespace
}  // namespace scancal
