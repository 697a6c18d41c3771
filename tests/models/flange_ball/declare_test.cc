// What a dataset.yaml with a ball on the flange may say, and what it is told if it says something else.
#include <gmock/gmock.h>
#include <numbers>
#include "io/units.h"
#include "models/flange_ball/scanner.h"
#include "tests/io/temporary_folder.h"

namespace scancal::flange_ball {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class FlangeBallDeclarationTest : public ::testing::Test {
 protected:
  FlangeBallDeclarationTest() {
    folder_.Write("a.csv", "# logged\n10,20,7\n\n30,-40,7\n");
    folder_.Write("b.csv", "q2,other,q1_rad\n20,x,1\n-40,y,2\n10,z,3\n");
  }

  // Of a sound data set, with one thing put in another's place.
  Result<Declaration> Declare(const std::string& from = "", const std::string& to = "") {
    std::string yaml =
        "scancal: 1\nmodel: flange-ball\nunits: {length: m, angle: deg}\n"
        "robot: {links: [{d: 0.3, a: 0.1, alpha: 90}, {theta: 5, d: 0, a: 0.2, alpha: 0, beta: 1}]}\n"
        "columns: [q1, q2, force]\n"
        "targets: [{name: near, sockets: [a.csv, b.csv]}]\n"
        "parameters: {spacing: {consider: 0.05, u: 0.0001}}\n";
    const size_t at = yaml.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    folder_.Write("dataset.yaml", yaml.replace(at, from.size(), to));
    SCANCAL_ASSIGN_OR_RETURN(const Dataset dataset, ReadDataset(folder_.path()));
    return flange_ball::Declare(dataset);
  }
  std::string ErrorOf(const std::string& from, const std::string& to) {
    const auto declaration = Declare(from, to);
    return declaration.ok() ? "" : declaration.error().message;
  }
  std::string ErrorOfTable(const std::string& contents, const std::vector<std::string>& columns = {"q1", "q2"}) {
    const auto table = folder_.Write("table.csv", contents);
    const auto tool = ReadTool(Tool({table, table}, columns), *Declare());
    return tool.ok() ? "" : tool.error().message;
  }

  static ToolDeclaration Tool(const std::array<std::filesystem::path, 2>& sockets,
                              const std::vector<std::string>& columns) {
    ToolDeclaration tool{"tool", sockets};
    tool.format.npy_columns = columns;
    return tool;
  }

  TemporaryFolder folder_;
};

TEST_F(FlangeBallDeclarationTest, UnitsRolesAndFiles) {
  const auto declaration = Declare("parameters: {",
                                   "influences: {joints: 0.01, seat: 0.0002}\nparameters: {a_1: hold, "
                                   "links: {estimate: 0, u_length: 0.001, u_angle: 2}, ");
  ASSERT_TRUE(declaration.ok()) << declaration.error().message;
  const Model& model = declaration->model;
  ASSERT_EQ(model.links().size(), 2U);
  EXPECT_DOUBLE_EQ(model.links()[0].d, 300);
  EXPECT_DOUBLE_EQ(model.links()[1].theta, 5 * kDegree);
  EXPECT_DOUBLE_EQ(model.links()[1].beta, 1 * kDegree);
  const auto quantity = [&](const char* name) { return model.quantities()[Find(model.quantities(), name)]; };
  EXPECT_EQ(quantity("spacing").role, Role::kConsider);
  EXPECT_DOUBLE_EQ(quantity("spacing").value, 50);
  EXPECT_DOUBLE_EQ(quantity("spacing").u, 0.1);
  EXPECT_EQ(quantity("a_1").role, Role::kHold);
  EXPECT_EQ(quantity("alpha_1").role, Role::kEstimate);
  EXPECT_DOUBLE_EQ(quantity("alpha_1").u, 2 * kDegree);
  EXPECT_EQ(quantity("theta_2").role, Role::kHold);
  EXPECT_EQ(quantity("seat_y").role, Role::kConsider);
  EXPECT_DOUBLE_EQ(quantity("seat_y").u, 0.2);
  EXPECT_DOUBLE_EQ(quantity("joint_2").u, 0.01 * kDegree);
  EXPECT_EQ(declaration->Files().size(), 3U);
}

TEST_F(FlangeBallDeclarationTest, WithoutAnyInfluenceTheSeatIsEstimated) {
  const auto declaration = Declare();
  ASSERT_TRUE(declaration.ok()) << declaration.error().message;
  EXPECT_EQ(declaration->model.quantities()[Model::kSeat].role, Role::kEstimate);
  EXPECT_EQ(declaration->model.quantities()[declaration->model.FirstOfJoints()].role, Role::kHold);
}

TEST_F(FlangeBallDeclarationTest, FilesWithAHeaderAndWithout) {
  auto declaration = Declare();
  ASSERT_TRUE(declaration.ok()) << declaration.error().message;
  const auto a = folder_.path() / "a.csv", b = folder_.path() / "b.csv";
  auto tool = ReadTool(declaration->targets[0], *declaration);
  EXPECT_FALSE(tool.ok());  // b has a header
  tool = ReadTool(Tool({a, a}, {"q1", "q2", "force"}), *declaration);
  ASSERT_TRUE(tool.ok()) << tool.error().message;
  ASSERT_EQ(tool->views.size(), 4U);
  EXPECT_THAT(tool->views[1].joints, ElementsAre(30 * kDegree, -40 * kDegree));
  EXPECT_EQ(tool->views[1].socket, 0);
  EXPECT_EQ(tool->views[2].socket, 1);
  tool = ReadTool(Tool({b, b}, {}), *declaration);
  ASSERT_TRUE(tool.ok()) << tool.error().message;
  EXPECT_THAT(tool->views[2].joints, ElementsAre(3, 10 * kDegree));
  EXPECT_THAT(ReadTool(Tool({b, a}, {}), *declaration).error().message, HasSubstr("declare columns: [q1, q2"));
}

// As a controller writes them: other names, a column that tells the rows of this robot, joints in rad, J2 coupled.
TEST_F(FlangeBallDeclarationTest, TablesAsTheyAreWritten) {
  folder_.Write("a.csv", "exported\nRobot;A1;A2\nR1;0,5;0,25\nR2;7;7\nR1;-1;1\n");
  folder_.Write("b.csv", "exported\nRobot;A1;A2\nR1;0,1;0,2\nR1;0,3;0,4\n");
  const auto declaration =
      Declare("columns: [q1, q2, force]\ntargets: [{name: near, ",
              "columns: {q1: A1, q2: A2}\nwhere: {Robot: R1}\ntargets: [{name: near, units: {angle: rad}, ");
  ASSERT_TRUE(declaration.ok()) << declaration.error().message;
  const auto tool = ReadTool(declaration->targets[0], *declaration);
  ASSERT_TRUE(tool.ok()) << tool.error().message;
  ASSERT_EQ(tool->views.size(), 4U);
  EXPECT_THAT(tool->views[1].joints, ElementsAre(-1, 1));
  const auto coupled = Declare("robot: {", "robot: {coupled: {q2: q2 - q1}, ");
  ASSERT_TRUE(coupled.ok()) << coupled.error().message;
  ToolDeclaration renamed = Tool({folder_.path() / "a.csv", folder_.path() / "a.csv"}, {});
  renamed.format.names = {{"q1", "A1"}, {"q2", "A2"}};
  const auto turned = ReadTool(renamed, *coupled);
  ASSERT_TRUE(turned.ok()) << turned.error().message;
  EXPECT_THAT(turned->views[1].joints, ElementsAre(7 * kDegree, 0));
}

TEST_F(FlangeBallDeclarationTest, WrongDeclarationsAreTold) {
  EXPECT_THAT(ErrorOf("spacing: {consider: 0.05, u: 0.0001}", "a_1: hold"),
              AllOf(HasSubstr("parameters: spacing: expected the distance of the sockets"), HasSubstr("consider: 50")));
  EXPECT_THAT(ErrorOf("spacing: {consider: 0.05, u: 0.0001}", "spacing: {estimate: 0.05}"),
              HasSubstr("spacing: not determined by these data; give a prior"));
  EXPECT_THAT(ErrorOf("spacing: {consider: 0.05, u: 0.0001}", "spacing: hold"), HasSubstr("expected its value"));
  EXPECT_THAT(ErrorOf("spacing:", "spaceing:"), HasSubstr("did you mean 'spacing'?"));
  EXPECT_THAT(ErrorOf("spacing:", "socket_x: hold, spacing:"), HasSubstr("socket_x: unknown parameter"));
  EXPECT_THAT(ErrorOf("spacing:", "links: {estimate: 0, u_length: -1}, spacing:"), HasSubstr("not negative"));
  EXPECT_THAT(ErrorOf("[a.csv, b.csv]", "[a.csv]"), HasSubstr("sockets: "));
  EXPECT_THAT(ErrorOf("[a.csv, b.csv]", "[a.csv, a.csv]"), HasSubstr("expected two files"));
  EXPECT_THAT(ErrorOf("b.csv]}]", "b.csv]}, {name: near, sockets: [c.csv, d.csv]}]"), HasSubstr("no other location"));
  EXPECT_THAT(ErrorOf("b.csv]}]", "b.csv]}]\ncheck: [{name: near, sockets: [c.csv, d.csv]}]"),
              HasSubstr("no other location"));
  EXPECT_THAT(ErrorOf("targets: [{name: near, sockets: [a.csv, b.csv]}]", "targets: []"), HasSubstr("targets"));
  EXPECT_THAT(ErrorOf("columns", "colums"), HasSubstr("did you mean 'columns'?"));
  EXPECT_THAT(ErrorOf("columns: [q1, q2, force]", "columns: {q3: A3, q4: A4}"),
              HasSubstr("columns: q4: no column has this name here"));
  EXPECT_THAT(ErrorOf("robot: {", "robot: {coupled: {q2: q1}, "), HasSubstr("{q3: q3 + q2}"));
  EXPECT_THAT(ErrorOf("alpha: 90", "alpha: x"), HasSubstr("expected a number"));
  EXPECT_THAT(ErrorOf("parameters:", "influences: {seat: 0}\nparameters:"), HasSubstr("every pose has noise"));
  EXPECT_THAT(ErrorOf("parameters:", "influences: {seats: 1}\nparameters:"), HasSubstr("did you mean 'seat'?"));
}

TEST_F(FlangeBallDeclarationTest, WrongTablesAreTold) {
  EXPECT_THAT(ErrorOfTable("10,20\n30,x\n"), HasSubstr("table.csv:2:4: q2: found \"x\", expected a number"));
  EXPECT_THAT(ErrorOfTable("10,20\n30\n"), HasSubstr("table.csv:2: found 1 cell, expected 2"));
  EXPECT_THAT(ErrorOfTable("10,20\n30,\n"), HasSubstr("table.csv:2:4: q2"));
  EXPECT_THAT(ErrorOfTable("10,20\n"), HasSubstr("found 1 pose, expected two or more"));
  EXPECT_THAT(ErrorOfTable("10,20\n30,1e9\n"), AllOf(HasSubstr("table.csv:2:4: q2"), HasSubstr("are these degrees?")));
  EXPECT_THAT(ErrorOfTable("1.5,2\n-1,0.3\n"), AllOf(HasSubstr("expected a robot that moves"), HasSubstr("radians")));
  EXPECT_THAT(ErrorOfTable("10,20\n30,40\n", {}), HasSubstr("if the file has no header, declare columns: [q1, q2, "));
  EXPECT_EQ(ErrorOfTable("10;20\n30;40\n"), "");  // in any dialect
  EXPECT_THAT(ErrorOfTable("10,20,5\n30,40,6\n", {"q1", "q2", "q3"}),
              HasSubstr("found the column q3, expected 2 joints"));
  EXPECT_EQ(ErrorOfTable("10,20\n30,40\n"), "");
}

}  // namespace
}  // namespace scancal::flange_ball
