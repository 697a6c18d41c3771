#include "models/robot_ball/fit.h"
#include <gtest/gtest.h>
#include "models/robot_ball/simulate.h"
#include "models/robot_ball/start.h"

namespace scancal::robot_ball {
namespace {

Measurements ExactMeasurements() {
  Scene scene;
  scene.repeatability = scene.ball_noise = scene.u_spheres = 0;
  return Simulate(scene).data;
}

TEST(FitJointly, StartsFromTheLinksOfTheModel) {
  const Measurements data = ExactMeasurements();
  Model model(data.links, data.spheres);
  constexpr int kLast = Model::kLinks + 5 * kLinkNumbers, kD = 1, kA = 2;
  model.quantity(kLast + kD).value = 20;             // held
  model.quantity(Model::kLinks + kA).value = 0.125;  // estimated
  const Result<Kinematics> start = InitialHandEye(data);
  ASSERT_TRUE(start.ok()) << start.error().message;
  const Result<JointFit> fit = FitJointly(data, model, start->flange_from_scanner);
  ASSERT_TRUE(fit.ok()) << fit.error().message;
  Kinematics expected{start->flange_from_scanner, std::vector<Link>(6)};
  expected.link_errors[5].d = 20;
  expected.link_errors[0].a = 0.125;
  const auto stations = StationsAt(data, expected);
  for (size_t s = 0; s < stations->size(); ++s)
    EXPECT_TRUE(fit->stations[s].base_from_artifact.isApprox((*stations)[s].base_from_artifact, 1e-12)) << s;
  ASSERT_EQ(fit->Found().link_errors.size(), 6U);
  EXPECT_EQ(fit->Found().link_errors[5].d, 20);
  EXPECT_NE(fit->Found().link_errors[0].a, 0.125);
}

TEST(FitJointly, PosesOfTheFlangeHaveNoLinkErrors) {
  Measurements data = ExactMeasurements();
  for (Station& station : data.stations)
    for (Model::View& view : station.views) {
      view.base_from_flange = BaseFromFlange(data.links, view.joints);
      view.joints.clear();
    }
  data.links.clear();
  const Result<JointFit> fit = FitJointly(data, Model({}, data.spheres), PublishedHandEye());
  ASSERT_TRUE(fit.ok()) << fit.error().message;
  EXPECT_TRUE(fit->Found().link_errors.empty());
}

}  // namespace
}  // namespace scancal::robot_ball
