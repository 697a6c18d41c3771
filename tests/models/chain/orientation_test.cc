// Turns as controllers write them, against what their makers' manuals say.
#include "models/chain/orientation.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <cmath>
#include "tests/io/temporary_folder.h"

namespace scancal {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;

class OrientationTest : public ::testing::Test {
 protected:
  // The turn of the first line, or the complaint.
  Result<Matrix3d> Read(const std::string& name, const std::string& text, const Units& units = {}) {
    SCANCAL_ASSIGN_OR_RETURN(const Orientation orientation, Orientation::Named(name));
    std::vector<TableColumn> columns = {{"pose"}};
    for (const TableColumn& column : orientation.Columns(true, "")) columns.push_back(column);
    SCANCAL_ASSIGN_OR_RETURN(const Table table, Table::Read(folder_.Write("t.csv", text), columns, units));
    SCANCAL_ASSIGN_OR_RETURN(const auto turns, orientation.Read(table));
    return turns[0];
  }
  std::string Error(const std::string& name, const std::string& text) {
    const auto turn = Read(name, text);
    return turn.ok() ? "" : turn.error().message;
  }
  void Expect(const std::string& name, const std::string& text, const Matrix3d& expected, const Units& units = {}) {
    const auto turn = Read(name, text, units);
    ASSERT_TRUE(turn.ok()) << turn.error().message;
    EXPECT_LT((*turn - expected).norm(), 1e-12) << name << "\n" << *turn << "\nexpected\n" << expected;
  }
  static Matrix3d About(char axis, double deg) {
    return AngleAxisd(deg * kDegree, Vector3d::Unit(axis - 'X')).toRotationMatrix();
  }
  TemporaryFolder folder_;
};

// Written by hand: a turn of 90 deg about z, then of 30 deg about the new y, then of 10 deg about the new x.
TEST_F(OrientationTest, VendorsByName) {
  const Matrix3d turn = About('Z', 90) * About('Y', 30) * About('X', 10);
  Expect("KUKA ABC", "pose,A,B,C\nP1,90,30,10\n", turn);
  Expect("FANUC WPR", "pose,W,P,R\nP1,10,30,90\n", turn);
  const Eigen::Quaterniond q(turn);
  const auto numbers = [](std::initializer_list<double> all) {
    std::string text = "P1";
    for (const double each : all) text += "," + std::to_string(each);
    return text + "\n";
  };
  const auto close = [&](const std::string& name, const std::string& text) {
    const auto read = Read(name, text);
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_LT((*read - turn).norm(), 1e-5) << name;  // six digits
  };
  close("ABB", "pose,q1,q2,q3,q4\n" + numbers({q.w(), q.x(), q.y(), q.z()}));
  close("quaternion wxyz", "pose,Q1,Q2,Q3,Q4\n" + numbers({q.w(), q.x(), q.y(), q.z()}));
  close("quaternion xyzw", "pose,q1,q2,q3,q4\n" + numbers({q.x(), q.y(), q.z(), q.w()}));
  close("quaternion", "pose,qw,qx,qy,qz\n" + numbers({q.w(), q.x(), q.y(), q.z()}));
  const AngleAxisd vector(turn);
  const Vector3d r = vector.angle() * vector.axis();
  close("UR", "pose,rx_rad,ry_rad,rz_rad\n" + numbers({r[0], r[1], r[2]}));
  close("rotation matrix", "pose,r11,r12,r13,r21,r22,r23,r31,r32,r33\n" +
                               numbers({turn(0, 0), turn(0, 1), turn(0, 2), turn(1, 0), turn(1, 1), turn(1, 2),
                                        turn(2, 0), turn(2, 1), turn(2, 2)}));
}

// Each of the 12 orders, against the product written out; fixed axes are the same product the other way round.
TEST_F(OrientationTest, EulerAnglesOfEveryOrder) {
  int orders = 0;
  for (const char a : {'X', 'Y', 'Z'})
    for (const char b : {'X', 'Y', 'Z'})
      for (const char c : {'X', 'Y', 'Z'}) {
        if (a == b || b == c) continue;
        ++orders;
        const std::string order = {a, b, c};
        std::string head = "pose,r1,r2,r3\n", row = "P1,20,-35,110\n";
        if (a != c) head = std::string("pose,r") + char(a | 32) + ",r" + char(b | 32) + ",r" + char(c | 32) + "\n";
        Expect(order + " intrinsic", head + row, About(a, 20) * About(b, -35) * About(c, 110));
        Expect(order + " extrinsic", head + row, About(c, 110) * About(b, -35) * About(a, 20));
      }
  EXPECT_EQ(orders, 12);
}

// A column is told by its axis, not by its place.
TEST_F(OrientationTest, TheOrderOfColumnsDoesNotMatter) {
  Expect("xyz-Intrinsic", "pose,rz,rx,ry\nP1,3,10,20\n", About('X', 10) * About('Y', 20) * About('Z', 3));
  Units rad;
  rad.angle_in_rad = 1;
  Expect("XYZ extrinsic", "pose,rx,ry,rz\nP1,1,0.5,0.25\n",
         (AngleAxisd(0.25, Vector3d::UnitZ()) * AngleAxisd(0.5, Vector3d::UnitY()) * AngleAxisd(1, Vector3d::UnitX()))
             .toRotationMatrix(),
         rad);
  Expect("UR", "pose,rx,ry,rz\nP1,0,0,0\n", Matrix3d::Identity());
}

TEST_F(OrientationTest, WhatIsNotToldIsAsked) {
  EXPECT_THAT(Error("XYZ", ""), AllOf(HasSubstr("XYZ intrinsic"), HasSubstr("XYZ extrinsic")));
  EXPECT_THAT(Error("euler", ""), AllOf(HasSubstr("KUKA ABC"), HasSubstr("rotation vector (UR)"), HasSubstr("wxyz")));
  EXPECT_THAT(Error("XXZ intrinsic", ""), HasSubstr("expected one of"));
  EXPECT_THAT(Error("XYZ moving", ""), HasSubstr("expected XYZ intrinsic"));
}

TEST_F(OrientationTest, WhatIsNoTurnIsToldByPoseAndColumn) {
  EXPECT_THAT(Error("ABB", "pose,Q1,Q2,Q3,Q4\nP1,1,0,0,0\nP2,1,1,0,0\n"),
              AllOf(HasSubstr("t.csv:3:6: Q2: the quaternion wxyz Q1, Q2, Q3, Q4 of pose \"P2\""),
                    HasSubstr("length 1.41421, expected 1")));
  EXPECT_THAT(Error("KUKA", "pose,A,B,C\nP1,1,2000,3\n"),
              AllOf(HasSubstr("t.csv:2:6: B: the angle of pose \"P1\" is 34.91 rad"), HasSubstr("are these degrees?")));
  EXPECT_THAT(Error("FANUC", "pose,W,P,R\nP1,3.1,0,-1.5\nP2,2,1,1\n"),
              AllOf(HasSubstr("lie within 3.1 deg"), HasSubstr("are these radians?")));
  const std::string head = "pose,r11,r12,r13,r21,r22,r23,r31,r32,r33\n";
  EXPECT_THAT(Error("rotation matrix", head + "P1,1,0,0,0,1,0,0,0,-1\n"), HasSubstr("mirrors"));
  EXPECT_THAT(Error("rotation matrix", head + "P1,1,0,0,0,1,0.1,0,0,1\n"), HasSubstr("right angles"));
}

}  // namespace
}  // namespace scancal
