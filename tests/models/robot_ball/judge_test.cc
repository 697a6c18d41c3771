// What a robot's calibration says of data that cannot be right.
#include "models/robot_ball/judge.h"
#include <gmock/gmock.h>
#include "io/units.h"
#include "models/robot_ball/published.h"
#include "models/robot_ball/simulate.h"
#include "models/robot_ball/start.h"

namespace scancal::robot_ball {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// The doubts about these data, checked against `before`.
std::vector<Sentence> Doubts(const Measurements& data, const std::vector<double>& before) {
  const Result<Kinematics> start = InitialHandEye(data);
  const Result<JointFit> fit = FitJointly(data, Model(data.links, data.spheres), start->flange_from_scanner);
  EXPECT_TRUE(fit.ok()) << fit.error().message;
  Calibration calibration;
  calibration.check.before = before;
  calibration.check.after = SpacingErrors(data, fit->Found());
  for (const CheckLength& length : data.check) calibration.check.names.push_back({length.name});
  Judge(data, *fit, &calibration);
  return calibration.unreliable;
}

Measurements FromSeed(uint64_t seed) {
  Scene scene;
  scene.seed = scene.noise_seed = seed;
  return Simulate(scene).data;
}

TEST(RobotVerdicts, RightDataRaiseNone) {
  for (uint64_t seed = 1; seed <= 8; ++seed) EXPECT_THAT(Doubts(FromSeed(seed), std::vector(10, 1.0)), IsEmpty());
}

TEST(RobotVerdicts, AWrongJointAngleIsFoundByItsPose) {
  for (const double degrees : {1.0, 10.0}) {
    Measurements data = FromSeed(1);
    Model::View& pose = data.stations[3].views[2];
    pose.joints[2] += degrees * kDegree;
    EXPECT_THAT(
        Doubts(data, std::vector(10, 100.0)),
        ElementsAre(HasSubstr("pose " + pose.name + " of station " + data.stations[3].name + ": its balls lie")));
  }
}

TEST(RobotVerdicts, LengthsThatBecomeWorseOrHaveAnotherUnitAreTold) {
  Measurements data = FromSeed(1);
  EXPECT_THAT(Doubts(data, std::vector(10, 0.001)), ElementsAre(HasSubstr("more than with the nominal robot")));
  data.check[2].distance /= 1000;
  EXPECT_THAT(Doubts(data, std::vector(10, 1.0)),
              ElementsAre(testing::AllOf(HasSubstr(data.check[2].name), HasSubstr("another unit"))));
}

}  // namespace
}  // namespace scancal::robot_ball
