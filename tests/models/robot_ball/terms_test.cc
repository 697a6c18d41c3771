// What a data set may say of terms, motors and temperature.
#include "io/json_file.h"
#include "models/robot_ball/scanner.h"
#include "tests/models/robot_ball/files.h"

namespace scancal::robot_ball {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class RobotTermsTest : public RobotFilesTest {};

TEST_F(RobotTermsTest, APriorOfNoUncertaintyIsRefusedWithWhatItMayMean) {
  EXPECT_THAT(ModelError("parameters: {links: {estimate: 0, u_length: 0, u_angle: 0.1}}\n"),
              AllOf(HasSubstr("u_length"), HasSubstr("above 0"), HasSubstr("links: hold")));
}

TEST_F(RobotTermsTest, MotorsNeedTheirGearRatios) {
  EXPECT_THAT(ModelError("influences: {motor: estimate}\n"), HasSubstr("robot: {gear_ratio: [121"));
  robot_ += "  gear_ratio: [121, 0, 101, 50, 50, 33.3]\n";
  more_ = "";
  const Declaration declaration = Declared();
  EXPECT_EQ(declaration.data.gear_ratios, (std::vector<double>{121, 0, 101, 50, 50, 33.3}));
  const Model::View& view = declaration.data.stations[1].views[1];
  const auto last = view.terms.end() - 12;  // cos and sin of each motor
  for (int k = 0; k < 6; ++k) {
    const double ratio = declaration.data.gear_ratios[static_cast<size_t>(k)];
    EXPECT_NEAR(last[2 * k], ratio == 0 ? 0 : std::cos(ratio * view.joints[static_cast<size_t>(k)]), 1e-12);
    EXPECT_NEAR(last[2 * k + 1], ratio == 0 ? 0 : std::sin(ratio * view.joints[static_cast<size_t>(k)]), 1e-12);
  }
  EXPECT_EQ(ModelError("influences: {motor_1: estimate}\n"), "");
  EXPECT_THAT(ModelError("influences: {motor_2: estimate}\n"), HasSubstr("motor_2"));
  for (const auto& [ratios, said] : {std::pair{"[121, 121]", "6 numbers"}, {"[1, 2, 3, 4, 5, x]", "more than once"}}) {
    robot_ = robot_.substr(0, robot_.find("  gear_ratio")) + "  gear_ratio: " + ratios + "\n";
    EXPECT_THAT(ModelError(""), HasSubstr(said));
  }
}

TEST_F(RobotTermsTest, TemperaturesCountFromTheirMean) {
  EXPECT_THAT(ModelError("influences: {expansion: 1e-5}\n"), HasSubstr("add a column temperature (degC)"));
  poses_[0] += ",temperature";
  for (size_t p = 1; p < poses_.size(); ++p) poses_[p] += "," + Numbers({20 + 2.0 * static_cast<double>(p)});
  const Model model = ModelWith("influences: {expansion: 1e-5}\n");
  EXPECT_EQ(model.quantities()[Model::kExpansion].role, Role::kConsider);
  const Declaration declaration = Declared();
  EXPECT_EQ(declaration.data.temperature, 27);
  EXPECT_EQ(declaration.data.stations[0].views[0].warmer, -5);
  EXPECT_EQ(declaration.data.stations[1].views[2].warmer, 5);
  const auto kept = FromJson(ToJson(declaration), "some.json");
  ASSERT_TRUE(kept.ok()) << kept.error().message;
  EXPECT_EQ(kept->data.temperature, 27);
  EXPECT_EQ(kept->data.stations[1].views[2].warmer, 5);
  poses_[2] += "x";
  EXPECT_THAT(Error(), HasSubstr("temperature"));
}

}  // namespace
}  // namespace scancal::robot_ball
