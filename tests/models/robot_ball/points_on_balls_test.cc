// Points on the balls in place of their centres.
#include <numbers>
#include "solver/random.h"
#include "tests/models/robot_ball/files.h"

namespace scancal::robot_ball {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class RobotPointsTest : public RobotFilesTest {
 protected:
  static constexpr double kRadius = 6.35, kNoise = 0.01;
  RobotPointsTest() {
    balls_ = {"pose,ball,file"};
    for (size_t p = 0; p < kJoints.size(); ++p)
      for (size_t k = 0; k < kCentres.size(); ++k) {
        const std::string file = "P" + std::to_string(p + 1) + kNames[k] + ".csv";
        WritePoints(file, Seen(p, k), p == 0 ? 400 : 100);
        balls_.push_back("P" + std::to_string(p + 1) + "," + kNames[k] + "," + file);
      }
  }
  // A cap as seen from the scanner.
  void WritePoints(const std::string& file, const Eigen::Vector3d& centre, int n, double radius = kRadius,
                   double lowest = 0.5) const {
    Random random(std::hash<std::string>()(file), 0);
    const Eigen::Vector3d z = -centre.normalized(), x = z.unitOrthogonal(), y = z.cross(x);
    std::string text = "x,y,z\n";
    for (int k = 0; k < n; ++k) {
      const double c = lowest + (1 - lowest) * random.Uniform(), s = std::sqrt(1 - c * c);
      const double phi = 2 * std::numbers::pi * random.Uniform();
      const Eigen::Vector3d p =
          centre + (radius + kNoise * random.Normal()) * (s * std::cos(phi) * x + s * std::sin(phi) * y + c * z);
      text += Numbers({p[0], p[1], p[2]}) + "\n";
    }
    folder_.Write(file, text);
  }
  static Eigen::Matrix3d Covariance(const Measurements& data, const Model::SeenBall& ball) {
    return std::pow(data.usual_ball_noise, 2) * ball.spread * ball.spread.transpose();
  }
};

TEST_F(RobotPointsTest, CentresAndTheirCovariance) {
  for (const std::string diameter : {"ball_diameter: 12.7\n", ""}) {
    more_ = diameter;
    const Declaration declaration = Declared();
    const Measurements& data = declaration.data;
    ASSERT_EQ(data.stations.size(), 2U);
    double squares = 0;
    for (size_t p = 0; p < 6; ++p) {
      const Model::View& view = data.stations[p / 3].views[p % 3];
      for (size_t k = 0; k < 5; ++k) {
        const Eigen::Vector3d off = view.balls[k].centre - Seen(p, k);
        squares += off.dot(Covariance(data, view.balls[k]).inverse() * off);
      }
    }
    EXPECT_NEAR(squares / 90, 1, 4 * std::sqrt(2.0 / 90)) << diameter;  // chi squared of 90 degrees of freedom
    // Four times the points, half the noise. Along the line of sight a known radius helps, and a free one blurs.
    const Model::SeenBall &many = data.stations[0].views[0].balls[0], &few = data.stations[0].views[1].balls[0];
    EXPECT_NEAR(many.spread.trace() / few.spread.trace(), 0.5, 0.1);
    const Eigen::Vector3d sight = few.centre.normalized(), across = sight.unitOrthogonal();
    const double ratio = sight.dot(Covariance(data, few) * sight) / across.dot(Covariance(data, few) * across);
    if (diameter.empty()) {
      EXPECT_GT(ratio, 2);
    } else {
      EXPECT_LT(ratio, 0.7);
    }
    EXPECT_EQ(declaration.files.size(), 34U);
    const Model model = *DeclareModel(declaration);
    EXPECT_EQ(model.quantities()[Model::kBall].role, Role::kEstimate);
  }
}

TEST_F(RobotPointsTest, ADeclaredNoiseIsThatOfTheMedianBall) {
  more_ = "ball_diameter: 12.7\n";
  const Declaration fitted = Declared();
  more_ = "ball_diameter: 12.7\ninfluences: {ball: 0.02}\n";
  const Declaration declared = Declared();
  EXPECT_EQ(declared.data.usual_ball_noise, 0.02);
  EXPECT_EQ(declared.data.stations[0].views[0].balls[0].spread, fitted.data.stations[0].views[0].balls[0].spread);
  EXPECT_EQ(DeclareModel(declared)->quantities()[Model::kBall].u, 0.02);
}

TEST_F(RobotPointsTest, PointsElsewhereAreSetAsideAndCounted) {
  more_ = "ball_diameter: 12.7\n";
  const Eigen::Vector3d before = Declared().data.stations[0].views[1].balls[2].centre;
  std::string text = folder_.Read("P2C.csv");
  for (int k = 0; k < 40; ++k) text += Numbers({before[0] + 0.1 * k, before[1] + 12, before[2] - 3}) + "\n";
  folder_.Write("P2C.csv", text);
  const Declaration declaration = Declared();
  EXPECT_LT((declaration.data.stations[0].views[1].balls[2].centre - before).norm(), 1e-3);
  EXPECT_THAT(declaration.warnings, Contains(AllOf(HasSubstr("points on balls were set aside"), HasSubstr("of 4540"))));
}

TEST_F(RobotPointsTest, BadPointsAreRefused) {
  more_ = "ball_diameter: 12.7\n";
  WritePoints("P2C.csv", Seen(1, 2), 3);
  EXPECT_THAT(Error(), AllOf(HasSubstr("balls.csv:9:6: file: "), HasSubstr("P2C.csv: found 3 points, expected four")));
  WritePoints("P2C.csv", Seen(1, 2), 100, 10);
  EXPECT_THAT(Error(), AllOf(HasSubstr("sphere of diameter 20"), HasSubstr("expected ball_diameter, 12.7 mm")));
  WritePoints("P2C.csv", Seen(1, 2), 100, kRadius, 0.999);  // 6 um high, of 10 um noise
  EXPECT_THAT(Error(), HasSubstr("P2C.csv: the points lie on a plane within their noise"));
  folder_.Write("P2C.csv", "x,y\n1,2\n");
  EXPECT_THAT(Error(), HasSubstr("P2C.csv:1: found the columns x, y"));
  std::filesystem::remove(folder_.path() / "P2C.csv");
  EXPECT_THAT(Error(), HasSubstr("P2C.csv: no such file"));
  balls_ = {"pose,ball", "P1,A"};
  EXPECT_THAT(Error(), HasSubstr("expected the columns x, y, z of the balls' centres, or file"));
}

TEST_F(RobotPointsTest, OneLaserLineIsACircle) {
  more_ = "ball_diameter: 12.7\n";
  std::string text = "x,y,z\n";
  const Eigen::Vector3d c = Seen(1, 2);
  for (int k = 0; k < 60; ++k) {
    const double phi = 0.03 * k + 0.5, noise = 0.01 * std::sin(17.0 * k);
    text += Numbers({c[0] + (6 + noise) * std::cos(phi), c[1] + std::sqrt(kRadius * kRadius - 36),
                     c[2] - (6 + noise) * std::sin(phi)}) +
            "\n";
  }
  folder_.Write("P2C.csv", text);
  EXPECT_THAT(Error(),
              AllOf(HasSubstr("P2C.csv: the points lie on a plane"), HasSubstr("one laser line sees only a circle")));
}

}  // namespace
}  // namespace scancal::robot_ball
