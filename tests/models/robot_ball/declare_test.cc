// What a robot's data set may say, and what comes of it.
#include "io/json_file.h"
#include "models/chain/urdf.h"
#include "models/robot_ball/scanner.h"
#include "tests/models/robot_ball/files.h"

namespace scancal::robot_ball {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class RobotDeclarationTest : public RobotFilesTest {};

// Every residual of exact data vanishes at the truth.
void ExpectExact(const Declaration& declaration, const Eigen::Isometry3d& hand_eye,
                 const std::function<Eigen::Isometry3d(size_t)>& base_from_artifact) {
  const auto model = DeclareModel(declaration);
  ASSERT_TRUE(model.ok()) << model.error().message;
  size_t pose = 0, balls = 0;
  for (Station station : declaration.data.stations) {
    station.base_from_artifact = base_from_artifact(pose);
    for (const Model::View& view : station.views) {
      const Eigen::Isometry3d flange =
          declaration.data.links.empty() ? view.base_from_flange : BaseFromFlange(declaration.data.links, view.joints);
      for (const Model::SeenBall& ball : view.balls) {
        const Eigen::Vector3d in_base =
            station.base_from_artifact * declaration.data.spheres[static_cast<size_t>(ball.sphere)].centre;
        EXPECT_LT((flange * hand_eye * ball.centre - in_base).norm(), 1e-9) << view.name;
        ++balls;
      }
      ++pose;
    }
  }
  EXPECT_EQ(pose, 6U);
  EXPECT_EQ(balls, 30U);
}

TEST_F(RobotDeclarationTest, JointAnglesAndCentres) {
  const Declaration declaration = Declared();
  EXPECT_THAT(declaration.warnings, IsEmpty());
  ASSERT_EQ(declaration.data.links.size(), 6U);
  EXPECT_NEAR(declaration.data.links[0].alpha, -90 * kDegree, 1e-15);
  ASSERT_EQ(declaration.data.stations.size(), 2U);
  EXPECT_EQ(declaration.data.stations[1].name, "right");
  EXPECT_EQ(declaration.data.stations[1].views[0].name, "P4");
  EXPECT_EQ(declaration.data.usual_ball_noise, 0);
  EXPECT_THAT(declaration.files, ElementsAre(folder_.path() / "dataset.yaml", folder_.path() / "poses.csv",
                                             folder_.path() / "balls.csv", folder_.path() / "artifact.csv"));
  ExpectExact(declaration, HandEye(), BaseFromArtifact);
}

TEST_F(RobotDeclarationTest, FlangePosesNeedNoLinks) {
  UseFlangePoses();
  const Declaration declaration = Declared();
  EXPECT_THAT(declaration.data.links, IsEmpty());
  ExpectExact(declaration, HandEye(), BaseFromArtifact);
}

TEST_F(RobotDeclarationTest, UnitsApplyToEveryNumberUnlessAColumnSaysOtherwise) {
  top_ = "scancal: 1\nmodel: robot-ball\nunits: {length: m, angle: rad}\n";
  robot_ =
      "robot: {links: [{d: 0.4, a: 0.025, alpha: -1.5707963267948966}, {d: 0, a: 0.56, alpha: 0}, "
      "{d: 0, a: 0.035, alpha: -1.5707963267948966}, {d: 0.515, a: 0, alpha: 1.5707963267948966}, "
      "{d: 0, a: 0, alpha: -1.5707963267948966}, {d: 0.08, a: 0, alpha: 0}]}\n";
  poses_[0] = "station,pose,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg";
  balls_[0] = "pose,ball,x_mm,y_mm,z_mm";
  artifact_[0] = "ball,x_mm,y_mm,z_mm";
  more_ = "ball_diameter: 0.0127\n";
  const Declaration declaration = Declared();
  EXPECT_NEAR(declaration.data.ball_diameter, 12.7, 1e-12);
  ExpectExact(declaration, HandEye(), BaseFromArtifact);
}

// As a controller and a scanner write them: other names, semicolons and decimal commas, rows of another robot, m, rad.
TEST_F(RobotDeclarationTest, TablesInAnyDialectWithNamesAndUnitsOfTheirOwn) {
  const auto rewrite = [](const std::string& head, std::vector<std::string>* lines) {
    for (std::string& line : *lines)
      for (char& c : line) c = c == ',' ? ';' : c == '.' ? ',' : c;
    (*lines)[0] = head;
  };
  for (size_t p = 0; p < kJoints.size(); ++p) {
    std::vector<double> joints = kJoints[p];
    for (double& q : joints) q *= kDegree;
    joints[2] -= joints[1];  // counted from the horizontal
    poses_[p + 1] = (p < 3 ? "left,P" : "right,P") + std::to_string(p + 1) + "," + Numbers(joints);
    for (size_t k = 0; k < kCentres.size(); ++k)
      balls_[1 + p * kCentres.size() + k] = Row("P" + std::to_string(p + 1), k, Seen(p, k) / 1000) + ",3";
  }
  rewrite("Ort;Pose;A1;A2;A3;A4;A5;A6", &poses_);
  rewrite("Pose;Ball;X;Y;Z;Scanner", &balls_);
  rewrite("", &artifact_);
  balls_.push_back("P1;A;1;2;3;4");
  poses_.insert(poses_.begin(), "KRC4;exported");
  robot_ += "  coupled: {q3: q3 + q2}\n";
  rest_ =
      "poses: {file: poses.csv, columns: {station: Ort, q1: A1, q2: A2, q3: A3, q4: A4, q5: A5, q6: A6}, "
      "units: {angle: rad}}\n"
      "observations: {file: balls.csv, where: {Scanner: 3}, units: {length: m}}\n"
      "artifact: {file: artifact.csv, columns: [ball, x, y, z], text: {separator: \";\", decimal: \",\"}}\n";
  const Declaration declaration = Declared();
  ExpectExact(declaration, HandEye(), BaseFromArtifact);
  EXPECT_EQ(Said(declaration.arm.couplings), " Joint 3 turns by q3 + q2.");
  EXPECT_THAT(declaration.echo,
              AllOf(HasSubstr("poses.csv: cells between"), HasSubstr("decimal commas, names in line 2")));
}

// `columns:` and `text:` at the top are for all tables.
TEST_F(RobotDeclarationTest, NamesForAllTables) {
  balls_[0] = "Punkt,Kugel,x,y,z";
  poses_[0] = "station,Punkt,q1,q2,q3,q4,q5,q6";
  artifact_[0] = "Kugel,x,y,z";
  more_ = "columns: {pose: Punkt, ball: Kugel}\ntext: {separator: \",\"}\n";
  ExpectExact(Declared(), HandEye(), BaseFromArtifact);
  more_ = "columns: {pose: Punkt, boll: Kugel}\n";
  EXPECT_THAT(Error(), HasSubstr("columns: boll: no column has this name"));
  more_ = "columns: [pose, ball]\n";
  EXPECT_THAT(Error(), HasSubstr("names in the order of a file belong to one table: poses: {file:"));
  more_ = "invalid: -1\n";
  EXPECT_THAT(Error(), HasSubstr("unknown key 'invalid'"));
}

// Poses without names are those of their lines.
TEST_F(RobotDeclarationTest, PosesWithoutNames) {
  for (std::string& line : poses_) line.erase(line.find(','), line.find(',', line.find(',') + 1) - line.find(','));
  for (std::string& line : balls_) line.erase(0, line[0] == 'P' ? 1 : 0);
  ExpectExact(Declared(), HandEye(), BaseFromArtifact);
}

// Poses of the flange as a KUKA shows them, in m and rad.
TEST_F(RobotDeclarationTest, TurnsAsTheyAreWritten) {
  UseFlangePoses();
  poses_[0] = "station,pose,X,Y,Z,A,B,C";
  for (size_t p = 0; p < kJoints.size(); ++p) {
    const Eigen::Isometry3d flange = Flange(p);
    const Eigen::Vector3d t = flange.translation() / 1000, abc = flange.linear().eulerAngles(2, 1, 0);
    poses_[p + 1] = (p < 3 ? "left,P" : "right,P") + std::to_string(p + 1) + "," +
                    Numbers({t[0], t[1], t[2], abc[0], abc[1], abc[2]});
  }
  EXPECT_THAT(Error(), AllOf(HasSubstr("expected also 'qx'"), HasSubstr("KUKA ABC"), HasSubstr("XYZ extrinsic")));
  rest_ =
      "poses: {file: poses.csv, orientation: KUKA, units: {length: m, angle: rad}}\nobservations: balls.csv\n"
      "artifact: artifact.csv\n";
  const Declaration declaration = Declared();
  ExpectExact(declaration, HandEye(), BaseFromArtifact);
  EXPECT_THAT(declaration.echo, HasSubstr("turns as KUKA ABC"));
  rest_.replace(rest_.find("KUKA"), 4, "ZYX");
  EXPECT_THAT(Error(), AllOf(HasSubstr("dataset.yaml:4:39: poses: orientation: found \"ZYX\""),
                             HasSubstr("ZYX intrinsic"), HasSubstr("ZYX extrinsic")));
}

// One table of a tracker's 6-DoF target, and of the joints: no names, each line a pose.
TEST_F(RobotDeclarationTest, ATargetSeenByATrackerInTheSameTable) {
  top_ = "scancal: 1\nmodel: robot-tracker\nunits: {length: mm, angle: deg}\n";
  balls_ = {"A1;A2;A3;A4;A5;A6;m x;m y;m z;m rx;m ry;m rz"};
  for (size_t p = 0; p < kJoints.size(); ++p) {
    const Eigen::Isometry3d target = BaseFromArtifact(0).inverse() * Flange(p) * HandEye();
    const Eigen::Vector3d t = target.translation(), r = target.linear().eulerAngles(0, 1, 2) / kDegree;
    std::string line = Numbers(kJoints[p]) + "," + Numbers({t[0], t[1], t[2], r[0], r[1], r[2]});
    for (char& c : line) c = c == ',' ? ';' : c == '.' ? ',' : c;
    balls_.push_back(line);
  }
  rest_ =
      "poses: {file: balls.csv, columns: {q1: A1, q2: A2, q3: A3, q4: A4, q5: A5, q6: A6}}\n"
      "observations: {file: balls.csv, orientation: XYZ intrinsic,\n"
      "  columns: {x: m x, y: m y, z: m z, rx: m rx, ry: m ry, rz: m rz}}\n";
  const Declaration declaration = Declared();
  ASSERT_EQ(declaration.data.stations.size(), 1U);
  const std::vector<Model::View>& views = declaration.data.stations[0].views;
  ASSERT_EQ(views.size(), 6U);
  EXPECT_EQ(declaration.files.size(), 2U);
  for (size_t p = 0; p < views.size(); ++p) {
    EXPECT_EQ(views[p].name, std::to_string(p + 1));
    for (const Model::SeenBall& ball : views[p].balls) {
      const Eigen::Vector3d in_base = Flange(p) * HandEye() * declaration.data.spheres[ball.sphere].centre;
      EXPECT_LT((BaseFromArtifact(0) * ball.centre - in_base).norm(), 1e-9);
    }
  }
  poses_.resize(4);
  poses_[0] = "station,nr,q1,q2,q3,q4,q5,q6";
  rest_.replace(0, rest_.find('\n'), "poses: poses.csv");
  EXPECT_THAT(Error(), AllOf(HasSubstr("balls.csv: found 6 lines, but 3 in"), HasSubstr("or a column 'pose' in both")));
  poses_[0] = "station,pose,q1,q2,q3,q4,q5,q6";
  EXPECT_THAT(Error(), HasSubstr("balls.csv: found no column 'pose', expected one with the names that"));
  rest_ = "poses: poses.csv\nobservations: {file: balls.csv, columns: {x: m x, y: m y, z: m z}}\n";
  EXPECT_THAT(Error(), AllOf(HasSubstr("the turn of a 6-DoF target"), HasSubstr("XYZ intrinsic")));
}

// The nominal links of a URDF, which the result keeps.
TEST_F(RobotDeclarationTest, LinksOfAUrdf) {
  folder_.Write("arm.urdf", UrdfOf("arm", {Links(), Eigen::Isometry3d::Identity(), {}}, {}, {}));
  robot_ = "robot: {urdf: arm.urdf, tip: flange}\n";
  const Declaration declaration = Declared();
  ExpectExact(declaration, HandEye(), BaseFromArtifact);
  EXPECT_EQ(declaration.arm.joints.size(), 6U);
  EXPECT_THAT(declaration.files, ::testing::Contains(folder_.path() / "arm.urdf"));
  const auto dataset = ReadDataset(folder_.path());
  ASSERT_TRUE(dataset.ok());
  const auto scanner = Load(*dataset);
  ASSERT_TRUE(scanner.ok()) << scanner.error().message;
  const auto data = (*scanner)->Data();
  ASSERT_TRUE(data.ok());
  std::filesystem::remove(folder_.path() / "arm.urdf");
  const auto again = Reload(*dataset, *data, "calibration.json");
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_EQ((*again)->Describe(), (*scanner)->Describe());
  EXPECT_EQ(*(*again)->Data(), *data);
  EXPECT_THAT(Load(*dataset).error().message, HasSubstr("arm.urdf"));
  robot_ = "robot: {urdf: arm.urdf, tip: flange, links: [{d: 1, a: 2, alpha: 3}]}\n";
  EXPECT_THAT(Error(), HasSubstr("expected links or a urdf, not both"));
}

TEST_F(RobotDeclarationTest, TheOrderOfLinesDoesNotMatter) {
  std::reverse(balls_.begin() + 1, balls_.end());
  std::swap(artifact_[1], artifact_[4]);
  ExpectExact(Declared(), HandEye(), BaseFromArtifact);
}

TEST_F(RobotDeclarationTest, QuotedNamesWithBlanksUmlautsAndCommas) {
  const auto rename = [](std::vector<std::string>* lines) {
    for (std::string& line : *lines)
      if (const size_t at = line.find("B,"); at != std::string::npos && (at == 0 || line[at - 1] == ','))
        line.replace(at, 1, "\"Kügel, links\"");
  };
  rename(&balls_);
  rename(&artifact_);
  balls_[0] = "\xEF\xBB\xBF" + balls_[0];
  balls_.insert(balls_.begin() + 3, {"", "# noch einmal"});
  for (std::string& line : balls_) line += "\r";
  const Declaration declaration = Declared();
  ASSERT_EQ(declaration.data.spheres.size(), 5U);
  EXPECT_EQ(declaration.data.spheres[1].name, "Kügel, links");
  ExpectExact(declaration, HandEye(), BaseFromArtifact);
}

TEST_F(RobotDeclarationTest, DefaultRoles) {
  const Model model = ModelWith("");
  const Model expected(Links(), model.spheres());
  ASSERT_EQ(model.quantities().size(), expected.quantities().size());
  for (size_t k = 0; k < model.quantities().size(); ++k) {
    EXPECT_EQ(model.quantities()[k].role, expected.quantities()[k].role) << model.quantities()[k].name;
    EXPECT_EQ(model.quantities()[k].u, 0) << model.quantities()[k].name;
  }
}

const Quantity& Of(const Model& model, const std::string& name) {
  const int index = Find(model.quantities(), name);
  EXPECT_GE(index, 0) << name;
  return model.quantities()[static_cast<size_t>(std::max(index, 0))];
}

TEST_F(RobotDeclarationTest, APriorOfAllLinksReachesThoseThatAreEstimatedByDefault) {
  const Model model = ModelWith(
      "parameters:\n  links: {estimate: 0, u_length: 0.5, u_angle: 0.1}\n  theta_2: {estimate: 0.01, u: 0.02}\n"
      "  a_1: estimate\n  d_4: {consider: 0, u: 0.3}\n  alpha_3: {hold: 0.02}\n  theta_1: {estimate: 0, u: 1}\n"
      "  hand_eye_x: {estimate: 30, u: 5}\n");
  EXPECT_NEAR(Of(model, "a_2").u, 0.5, 1e-12);
  EXPECT_NEAR(Of(model, "theta_3").u, 0.1 * kDegree, 1e-15);
  EXPECT_NEAR(Of(model, "theta_2").u, 0.02 * kDegree, 1e-15);
  EXPECT_NEAR(Of(model, "theta_2").value, 0.01 * kDegree, 1e-15);
  EXPECT_EQ(Of(model, "a_1").u, 0);  // named singly, without a prior
  EXPECT_EQ(Of(model, "d_4").role, Role::kConsider);
  EXPECT_EQ(Of(model, "alpha_3").role, Role::kHold);
  EXPECT_NEAR(Of(model, "alpha_3").value, 0.02 * kDegree, 1e-15);
  EXPECT_EQ(Of(model, "theta_1").role, Role::kEstimate);
  EXPECT_EQ(Of(model, "d_1").role, Role::kHold);  // by default
  EXPECT_EQ(Of(model, "d_1").u, 0);
  EXPECT_EQ(Of(model, "theta_6").role, Role::kHold);
  EXPECT_EQ(Of(model, "hand_eye_x").u, 5);
  EXPECT_EQ(Of(model, "hand_eye_y").u, 0);
}

TEST_F(RobotDeclarationTest, AllLinksHeldButOne) {
  const Model model = ModelWith("parameters: {links: hold, theta_2: estimate}\n");
  int estimated = 0;
  for (int k = Model::kLinks; k < model.FirstOfSpheres(); ++k)
    estimated += model.quantities()[static_cast<size_t>(k)].role == Role::kEstimate;
  EXPECT_EQ(estimated, 1);
  EXPECT_EQ(Of(model, "theta_2").role, Role::kEstimate);
}

TEST_F(RobotDeclarationTest, Influences) {
  const Model declared = ModelWith("influences: {ball: 0.02, repeatability: 0.04, artifact: 0.001}\n");
  EXPECT_EQ(Of(declared, "ball_y").role, Role::kConsider);
  EXPECT_EQ(Of(declared, "ball_y").u, 0.02);
  EXPECT_EQ(Of(declared, "repeatability_z").role, Role::kConsider);
  EXPECT_EQ(Of(declared, "repeatability_z").u, 0.04);
  EXPECT_EQ(Of(declared, "sphere_C_x").role, Role::kConsider);
  EXPECT_EQ(Of(declared, "sphere_C_x").u, 0.001);
  const Model estimated =
      ModelWith("influences: {ball: estimate, repeatability: hold, artifact: {estimate: 0, u: 0.002}}\n");
  EXPECT_EQ(Of(estimated, "ball_x").role, Role::kEstimate);
  EXPECT_EQ(Of(estimated, "repeatability_x").role, Role::kHold);
  EXPECT_EQ(Of(estimated, "sphere_E_z").role, Role::kEstimate);
  EXPECT_EQ(Of(estimated, "sphere_E_z").u, 0.002);
}

TEST_F(RobotDeclarationTest, UncertaintiesLineByLine) {
  balls_[0] += ",u";
  for (size_t k = 1; k < balls_.size(); ++k) balls_[k] += k == 1 ? ",0.06" : k == 2 ? "," : ",0.03";
  artifact_[0] += ",u";
  for (size_t k = 1; k < artifact_.size(); ++k) artifact_[k] += k == 1 ? ",0.004" : ",0";
  Declaration declaration = Declared();
  EXPECT_NEAR(declaration.data.usual_ball_noise, 0.03, 1e-12);
  const auto spread = [&](size_t ball) { return declaration.data.stations[0].views[0].balls[ball].spread; };
  EXPECT_TRUE(spread(0).isApprox(2 * Eigen::Matrix3d::Identity(), 1e-12));
  EXPECT_TRUE(spread(1).isApprox(Eigen::Matrix3d::Identity(), 1e-12));  // nothing was said: the usual
  EXPECT_NEAR(declaration.data.u_spheres, 0.004 / std::sqrt(5), 1e-12);
  const Model model = *DeclareModel(declaration);
  EXPECT_EQ(Of(model, "ball_x").role, Role::kConsider);
  EXPECT_NEAR(Of(model, "ball_x").u, 0.03, 1e-12);
  EXPECT_EQ(Of(model, "sphere_A_x").u, 0.004);
  EXPECT_EQ(Of(model, "sphere_B_x").role, Role::kHold);
  more_ = "influences: {ball: 0.06}\n";  // of the lines that say nothing
  declaration = Declared();
  EXPECT_TRUE(spread(0).isApprox(Eigen::Matrix3d::Identity(), 1e-12));
  EXPECT_TRUE(spread(2).isApprox(0.5 * Eigen::Matrix3d::Identity(), 1e-12));
  more_ = "influences: {ball: estimate}\n";
  EXPECT_EQ(Of(*DeclareModel(Declared()), "ball_x").role, Role::kEstimate);
}

class RobotCheckTest : public RobotFilesTest {
 protected:
  // A scale of balls S and T, 299.546 mm apart, at one position: as seen from poses 1 and 2.
  void WriteCheck(const std::vector<std::string>& balls) {
    more_ = "check: {poses: check_poses.csv, observations: check_balls.csv, distances: distances.csv}\n";
    folder_.Write("check_poses.csv", poses_[0] + "\nfirst,c1," + Numbers(kJoints[0]) + "\nfirst,c2," +
                                         Numbers(kJoints[1]) + "\nsecond,c3," + Numbers(kJoints[2]) + "\n");
    folder_.Write("check_balls.csv", "pose,ball,x,y,z\n" + Text(balls));
    folder_.Write("distances.csv", "ball_a,ball_b,distance,u\nS,T,299.546,0.002\n");
  }
};

TEST_F(RobotCheckTest, OneLengthAStationFromTwoPosesIfThereAreTwo) {
  WriteCheck({"c1,S,0,0,400", "c1,T,299.546,0,400", "c2,S,0,50,400", "c2,T,0,349.546,400", "c3,T,0,0,400",
              "c3,S,0,0,699.546"});
  const Declaration declaration = Declared();
  ASSERT_EQ(declaration.data.check.size(), 2U);
  const CheckLength& first = declaration.data.check[0];
  EXPECT_EQ(first.name, "S - T at first");
  EXPECT_EQ(first.first_pose.name, "c1");
  EXPECT_EQ(first.second_pose.name, "c2");
  ASSERT_EQ(first.first_pose.balls.size(), 1U);
  EXPECT_EQ(first.first_pose.balls[0].centre, Eigen::Vector3d(0, 0, 400));
  EXPECT_EQ(first.second_pose.balls[0].centre, Eigen::Vector3d(0, 349.546, 400));
  EXPECT_EQ(first.distance, 299.546);
  EXPECT_EQ(first.u, 0.002);
  EXPECT_EQ(declaration.data.check[1].first_pose.name, "c3");
  EXPECT_EQ(declaration.data.check[1].second_pose.name, "c3");
  EXPECT_THAT(declaration.warnings, ElementsAre(HasSubstr("1 of 2 lengths were seen from one pose")));
  EXPECT_EQ(declaration.files.size(), 7U);
}

TEST_F(RobotCheckTest, ThePoseOfTheSecondBallMayComeFirst) {
  WriteCheck({"c1,T,0,0,400", "c2,S,0,0,400"});
  const Declaration declaration = Declared();
  ASSERT_EQ(declaration.data.check.size(), 1U);
  EXPECT_EQ(declaration.data.check[0].first_pose.name, "c2");
  EXPECT_EQ(declaration.data.check[0].second_pose.name, "c1");
}

TEST_F(RobotCheckTest, BadChecksAreRefused) {
  WriteCheck({"c1,S,0,0,400", "c3,T,0,0,400"});
  EXPECT_THAT(Error(), HasSubstr("distances.csv:2:1: ball_a: no station of"));
  WriteCheck({"c1,S,0,0,400", "c9,T,0,0,400"});
  EXPECT_THAT(Error(), HasSubstr("check_balls.csv:3:1: pose: found \"c9\""));
  WriteCheck({"c1,S,0,0,400", "c2,U,0,0,400"});
  EXPECT_THAT(Error(), HasSubstr("check_balls.csv:3:4: ball: found \"U\""));
  WriteCheck({"c1,S,0,0,0.4", "c1,T,0.299546,0,0.4"});
  EXPECT_THAT(Error(), HasSubstr("0.001 times"));
}

}  // namespace
}  // namespace scancal::robot_ball
