// A robot's data that are damaged or cannot be what they are declared to be: told by name, with place and remedy.
#include "tests/models/robot_ball/files.h"

namespace scancal::robot_ball {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class RobotBadInputTest : public RobotFilesTest {
 protected:
  // The line of pose P<pose> (1-based) and the ball.
  std::string& BallLine(size_t pose, size_t ball) { return balls_[1 + (pose - 1) * kCentres.size() + ball]; }
  static void Replace(const std::string& from, const std::string& to, std::string* line) {
    const size_t at = line->find(from);
    ASSERT_NE(at, std::string::npos) << *line;
    line->replace(at, from.size(), to);
  }
};

TEST_F(RobotBadInputTest, UnknownNamesOfPosesAndBalls) {
  Replace("P3,", "P33,", &BallLine(3, 0));
  EXPECT_THAT(Error(), AllOf(HasSubstr("balls.csv:12:1: pose: found \"P33\""), HasSubstr("poses.csv"),
                             HasSubstr("did you mean 'P3'?")));
  Replace("P33,", "P3,", &BallLine(3, 0));
  Replace(",C,", ",c,", &BallLine(2, 2));
  EXPECT_THAT(Error(), AllOf(HasSubstr("balls.csv:9:4: ball: found \"c\""), HasSubstr("artifact.csv does not have")));
}

TEST_F(RobotBadInputTest, NamesTwice) {
  Replace(",B,", ",A,", &BallLine(2, 1));
  EXPECT_THAT(Error(), AllOf(HasSubstr("balls.csv:8:4: ball: found \"A\" again in pose \"P2\""),
                             HasSubstr("balls.csv:7)"), HasSubstr("remove it")));
  Replace(",A,", ",B,", &BallLine(2, 1));
  Replace(",P5,", ",P1,", &poses_[5]);
  EXPECT_THAT(Error(), AllOf(HasSubstr("poses.csv:6:7: pose: found \"P1\" again"), HasSubstr("poses.csv:2)")));
  Replace(",P1,", ",P5,", &poses_[5]);
  Replace("D,", "A,", &artifact_[4]);
  EXPECT_THAT(Error(), HasSubstr("artifact.csv:5:1: ball: found \"A\" again"));
}

TEST_F(RobotBadInputTest, FewBallsInAPoseAreFlagged) {
  balls_.erase(balls_.begin() + 3, balls_.begin() + 6);  // leaves two in P1
  EXPECT_THAT(Declared().warnings, ElementsAre(AllOf(HasSubstr("1 poses saw less than 3 balls"), HasSubstr("P1"))));
}

TEST_F(RobotBadInputTest, FewBallsInAStationAreRefused) {
  std::erase_if(balls_, [](const std::string& line) {
    return line[0] == 'P' && line[1] >= '4' && line.find(",A,") == std::string::npos &&
           line.find(",B,") == std::string::npos;
  });
  EXPECT_THAT(Error(),
              AllOf(HasSubstr("station \"right\" together saw 2 of the balls"), HasSubstr("remove the station")));
}

TEST_F(RobotBadInputTest, PosesThatSawNothingAreLeftOut) {
  balls_.erase(balls_.begin() + 1, balls_.begin() + 6);
  const Declaration declaration = Declared();
  EXPECT_THAT(declaration.warnings,
              ElementsAre(AllOf(HasSubstr("no ball was seen from 1 of its poses"), HasSubstr("P1"))));
  EXPECT_EQ(declaration.data.stations[0].views.size(), 2U);
}

TEST_F(RobotBadInputTest, SwappedUnitsOfLengths) {
  artifact_[0] = "ball,x_m,y_m,z_m";
  EXPECT_THAT(Error(), AllOf(HasSubstr("balls.csv: the balls lie 0.001 times as far apart"), HasSubstr("x_mm, x_m")));
  artifact_[0] = "ball,x,y,z";
  balls_[0] = "pose,ball,x_m,y_m,z_m";
  EXPECT_THAT(Error(), HasSubstr("1000 times"));
  balls_[0] = "pose,ball,x,y,z";
  for (size_t k = 0; k < kCentres.size(); ++k)
    artifact_[k + 1] = kNames[k] + "," + Numbers({kCentres[k][0] / 25.4, kCentres[k][1] / 25.4, kCentres[k][2] / 25.4});
  EXPECT_THAT(Error(), HasSubstr("25.4 times"));
}

TEST_F(RobotBadInputTest, AnArmOfAnotherUnit) {
  top_ = "scancal: 1\nmodel: robot-ball\nunits: {length: m, angle: deg}\n";
  EXPECT_THAT(Error(), AllOf(HasSubstr("dataset.yaml:6:5: robot: links: the arm is 1.62e+06 mm long"),
                             HasSubstr("units: length")));
  UseFlangePoses();
  balls_[0] = "pose,ball,x_mm,y_mm,z_mm";
  artifact_[0] = "ball,x_mm,y_mm,z_mm";
  EXPECT_THAT(Error(), AllOf(HasSubstr("poses.csv: the flange comes"), HasSubstr("units: length")));
}

TEST_F(RobotBadInputTest, DegreesAsRadians) {
  top_ = "scancal: 1\nmodel: robot-ball\nunits: {length: mm, angle: rad}\n";
  EXPECT_THAT(Error(), AllOf(HasSubstr("dataset.yaml:6:40: robot: links: item 1: alpha: found \"-90\""),
                             HasSubstr("are these degrees? See units: angle")));
  top_ = "scancal: 1\nmodel: robot-ball\nunits: {length: mm, angle: deg}\n";
  Replace("q3", "q3_rad", &poses_[0]);
  EXPECT_THAT(Error(),
              AllOf(HasSubstr("poses.csv:2:16: q3_rad: that is 95 rad in pose \"P1\", expected two turns at most"),
                    HasSubstr("q3_deg")));
}

TEST_F(RobotBadInputTest, RadiansAsDegrees) {
  Replace("alpha: -90", "alpha: -1.570796", &robot_);
  EXPECT_THAT(Error(), AllOf(HasSubstr("alpha: found \"-1.570796\", expected an angle in degrees")));
  Replace("alpha: -1.570796", "alpha: -90", &robot_);
  for (size_t p = 0; p < kJoints.size(); ++p) {
    std::vector<double> joints = kJoints[p];
    for (double& q : joints) q *= kDegree;
    poses_[p + 1] = (p < 3 ? "left,P" : "right,P") + std::to_string(p + 1) + "," + Numbers(joints);
  }
  EXPECT_THAT(Error(), AllOf(HasSubstr("poses.csv: all joint angles lie within 1.92 deg"), HasSubstr("q1_rad")));
}

TEST_F(RobotBadInputTest, QuaternionsThatAreNotNormalised) {
  UseFlangePoses();
  ASSERT_EQ(Error(), "");
  poses_[2] = "left,P2,600,0,700,0,0.5,0,0.5";
  EXPECT_THAT(Error(),
              AllOf(HasSubstr("poses.csv:3:19: qx: the quaternion"), HasSubstr("length 0.707107, expected 1")));
  poses_[2] = "left,P2,600,0,700,0,0,0,0";
  EXPECT_THAT(Error(), HasSubstr("length 0, expected 1"));
}

TEST_F(RobotBadInputTest, PosesThatDoNotTurn) {
  UseFlangePoses();
  const auto pose = [&](size_t p, const std::string& quaternion) {
    poses_[p] = (p < 4 ? "left,P" : "right,P") + std::to_string(p) + "," + std::to_string(600 + 20 * p) + ",10,700," +
                quaternion;
  };
  // Turned from station to station, and within each by a third of a degree.
  for (size_t p = 1; p <= 6; ++p) pose(p, p < 4 ? "0,0,0.003,1" : "0,0,0.7071,0.7071");
  EXPECT_THAT(Error(), AllOf(HasSubstr("poses.csv: within each station the flange turns by"), HasSubstr("two axes")));
  for (size_t p = 1; p <= 6; ++p)
    pose(p, Numbers({0, 0, std::sin(0.1 * static_cast<double>(p)), std::cos(0.1 * static_cast<double>(p))}));
  EXPECT_THAT(Declared().warnings, ElementsAre(AllOf(HasSubstr("about one axis only, ("), HasSubstr("1.00)"))));
}

TEST_F(RobotBadInputTest, StationsSeenOnce) {
  Replace("left", "other", &poses_[1]);
  EXPECT_THAT(Declared().warnings,
              ElementsAre(AllOf(HasSubstr("1 of 3 stations were seen from one pose"), HasSubstr("other"))));
  for (size_t p = 2; p <= 6; ++p) Replace(p < 4 ? "left" : "right", "s" + std::to_string(p), &poses_[p]);
  EXPECT_THAT(Error(), HasSubstr("every station was seen from one pose only"));
}

TEST_F(RobotBadInputTest, JointsAgainstLinks) {
  for (std::string& line : poses_) line = line.substr(0, line.rfind(','));
  EXPECT_THAT(Error(), AllOf(HasSubstr("poses.csv:1: found the columns"), HasSubstr("'q6'"),
                             HasSubstr("robot: links declares 6 joints")));
  for (std::string& line : poses_) line += ",0,0";
  Replace(",0,0", ",q6,q7", &poses_[0]);
  EXPECT_THAT(Error(), AllOf(HasSubstr("found the column q7"), HasSubstr("6 joints")));
  robot_.clear();
  EXPECT_THAT(Error(), AllOf(HasSubstr("'x'"), HasSubstr("joint angles need robot: links")));
}

TEST_F(RobotBadInputTest, AWrongNameOfABall) {
  // P2 saw A .. D, of which B is called E.
  balls_.erase(balls_.begin() + 10);
  Replace(",B,", ",E,", &BallLine(2, 1));
  EXPECT_THAT(Error(),
              AllOf(HasSubstr("balls.csv:8:4: ball: found \"E\", but in pose \"P2\""), HasSubstr("is it \"B\"?")));
}

TEST_F(RobotBadInputTest, ExchangedNamesOfBalls) {
  BallLine(3, 0) = Row("P3", 1, Seen(2, 0));
  BallLine(3, 1) = Row("P3", 0, Seen(2, 1));
  EXPECT_THAT(Error(), AllOf(HasSubstr("in pose \"P3\""), HasSubstr("are \"A\" and \"B\" exchanged?")));
}

TEST_F(RobotBadInputTest, ABallThatWasNotOne) {
  BallLine(5, 3) = Row("P5", 3, Seen(4, 3) + Eigen::Vector3d(0, 0, 30));
  EXPECT_THAT(Error(), AllOf(HasSubstr("balls.csv:25:4: ball: found \"D\""), HasSubstr("4 of its 4 distances"),
                             HasSubstr("remove the line")));
}

TEST_F(RobotBadInputTest, AMirrorImage) {
  for (size_t k = 0; k < kCentres.size(); ++k)
    artifact_[k + 1] = kNames[k] + "," + Numbers({kCentres[k][0], kCentres[k][1], -kCentres[k][2]});
  EXPECT_THAT(Error(), HasSubstr("mirror image"));
}

// 0.035 mm of noise is no wrong ball, nor is a scale error of a scanner.
TEST_F(RobotBadInputTest, NoiseIsNotMistaken) {
  for (size_t p = 0; p < kJoints.size(); ++p)
    for (size_t k = 0; k < kCentres.size(); ++k)
      BallLine(p + 1, k) = Row("P" + std::to_string(p + 1), k,
                               1.0005 * Seen(p, k) + 0.05 * Eigen::Vector3d(std::sin(7.0 * static_cast<double>(p + k)),
                                                                            std::cos(3.0 * static_cast<double>(p)),
                                                                            std::sin(5.0 * static_cast<double>(k))));
  EXPECT_THAT(Declared().warnings, IsEmpty());
}

TEST_F(RobotBadInputTest, KeysOfTheDataSet) {
  rest_ = "poses: poses.csv\nobservations: balls.csv\n";
  EXPECT_THAT(Error(), HasSubstr("the key 'artifact' is missing"));
  rest_ = "poses: poses.csv\nobservations: balls.csv\nartifact: artifact.csv\n";
  more_ = "ball_diametr: 12.7\n";
  EXPECT_THAT(Error(), HasSubstr("unknown key 'ball_diametr', did you mean 'ball_diameter'?"));
  more_ = "ball_diameter: -1\n";
  EXPECT_THAT(Error(), HasSubstr("ball_diameter: found \"-1\", expected a diameter above 0"));
  more_ = "check: {poses: a.csv, observations: b.csv}\n";
  EXPECT_THAT(Error(), HasSubstr("a.csv"));  // whole poses held out
  more_ = "check: {every: 1}\n";
  EXPECT_THAT(Error(), HasSubstr("every: found \"1\", expected a whole number, 2 or more"));
  more_ = "check: {every: 2, poses: a.csv}\n";
  EXPECT_THAT(Error(), HasSubstr("unknown key 'poses'"));
  more_ = "";
  Replace("a: 25", "r: 25", &robot_);
  EXPECT_THAT(Error(), AllOf(HasSubstr("robot: links: item 1: the key 'a' is missing")));
}

TEST_F(RobotBadInputTest, ParametersAndInfluences) {
  EXPECT_THAT(ModelError("parameters: {theta_9: estimate}\n"), HasSubstr("parameters: theta_9: unknown parameter"));
  EXPECT_THAT(ModelError("parameters: {repeatability_x: hold}\n"), HasSubstr("unknown parameter"));
  EXPECT_THAT(ModelError("parameters: {links: {estimate: 1}}\n"),
              HasSubstr("links: found a mapping, expected estimate, hold, or"));
  EXPECT_THAT(ModelError("parameters: {links: {estimate: 0, u: 1}}\n"), HasSubstr("u_length"));
  EXPECT_THAT(ModelError("parameters: {links: {estimate: 0, u_length: -1}}\n"), HasSubstr("not negative"));
  EXPECT_THAT(ModelError("parameters: {links: {estimate: 0, u_lenght: 1}}\n"), HasSubstr("did you mean 'u_length'?"));
  EXPECT_THAT(ModelError("parameters: {hand_eye_x: hold}\n"), HasSubstr("hold: expected its value"));
  EXPECT_THAT(ModelError("influences: {bal: 0.1}\n"), HasSubstr("bal: unknown influence, did you mean 'ball'?"));
  EXPECT_THAT(ModelError("influences: {ball: 0}\n"), HasSubstr("every ball has noise"));
  EXPECT_THAT(ModelError("influences: {ball: yes}\n"), HasSubstr("ball: found yes, expected"));
  EXPECT_THAT(ModelError("influences: {repeatability: {estimate: 0, u: 1}}\n"), HasSubstr("without a prior"));
  EXPECT_THAT(ModelError("influences: {artifact: estimate}\n"), HasSubstr("artifact: expected {estimate: 0, u: ...}"));
  UseFlangePoses();
  EXPECT_THAT(ModelError("parameters: {theta_2: estimate}\n"), HasSubstr("expected robot: links and joint angles"));
  EXPECT_THAT(ModelError("parameters: {links: estimate}\n"), HasSubstr("expected robot: links and joint angles"));
  EXPECT_EQ(ModelError("parameters: {hand_eye_x: {hold: 30}}\n"), "");
}

}  // namespace
}  // namespace scancal::robot_ball
