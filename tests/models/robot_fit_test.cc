#include "models/robot_ball/robot_fit.h"
#include <gtest/gtest.h>
#include "models/robot_ball/hand_eye.h"
#include "models/robot_ball/simulate.h"

namespace scancal {
namespace {

RobotData Noiseless() {
  RobotScene scene;
  scene.repeatability = scene.ball_noise = scene.u_spheres = 0;
  return SimulateRobot(scene).data;
}

TEST(FitRobot, StartsFromTheLinksOfTheModel) {
  const RobotData data = Noiseless();
  RobotBall model(data.links, data.spheres);
  constexpr int kLast = RobotBall::kLinks + 5 * kLinkNumbers, kD = 1, kA = 2;
  model.quantity(kLast + kD).value = 20;                 // held
  model.quantity(RobotBall::kLinks + kA).value = 0.125;  // estimated
  const Result<RobotSetup> start = InitialHandEye(data);
  ASSERT_TRUE(start.ok()) << start.error().message;
  const Result<RobotFit> fit = FitRobot(data, model, start->flange_from_scanner);
  ASSERT_TRUE(fit.ok()) << fit.error().message;
  RobotSetup expected{start->flange_from_scanner, std::vector<Link>(6)};
  expected.link_errors[5].d = 20;
  expected.link_errors[0].a = 0.125;
  const auto stations = StationsAt(data, expected);
  for (size_t s = 0; s < stations->size(); ++s)
    EXPECT_TRUE(fit->stations[s].base_from_artifact.isApprox((*stations)[s].base_from_artifact, 1e-12)) << s;
  ASSERT_EQ(fit->Setup().link_errors.size(), 6U);
  EXPECT_EQ(fit->Setup().link_errors[5].d, 20);
  EXPECT_NE(fit->Setup().link_errors[0].a, 0.125);
}

TEST(FitRobot, PosesOfTheFlangeHaveNoLinkErrors) {
  RobotData data = Noiseless();
  for (Station& station : data.stations)
    for (RobotBall::View& view : station.views) {
      view.base_from_flange = BaseFromFlange(data.links, view.joints);
      view.joints.clear();
    }
  data.links.clear();
  const Result<RobotFit> fit = FitRobot(data, RobotBall({}, data.spheres), PublishedHandEye());
  ASSERT_TRUE(fit.ok()) << fit.error().message;
  EXPECT_TRUE(fit->Setup().link_errors.empty());
}

}  // namespace
}  // namespace scancal
