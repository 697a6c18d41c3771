// What a URDF may hold, and what is wrong with one.
#include "io/urdf.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string Arm(const std::string& more = "") {
  return "<robot name=\"arm\">\n"
         "<joint name=\"a\" type=\"revolute\"><parent link=\"base\"/><child link=\"l1\"/>"
         "<origin xyz=\"0 0.5 -1e-1\" rpy=\"1 2 3\"/><axis xyz=\"0 0 1\"/></joint>\n"
         "<joint name=\"b\" type=\"fixed\"><parent link=\"l1\"/><child link=\"tool0\"/></joint>\n" +
         more + "</robot>\n";
}

std::string ErrorOf(const std::string& text, const std::string& tip = "tool0", const std::string& base = "") {
  const auto joints = ReadUrdf(text, "arm.urdf", base, tip);
  return joints.ok() ? "" : joints.error().message;
}

TEST(ReadUrdfTest, JointsFromTheRootToTheTip) {
  const auto joints = ReadUrdf(Arm(), "arm.urdf", "", "tool0");
  ASSERT_TRUE(joints.ok()) << joints.error().message;
  ASSERT_EQ(joints->size(), 2U);
  EXPECT_EQ((*joints)[0].name, "a");
  EXPECT_TRUE((*joints)[0].turns);
  EXPECT_THAT((*joints)[0].xyz, ElementsAre(0, 0.5, -0.1));
  EXPECT_THAT((*joints)[0].rpy, ElementsAre(1, 2, 3));
  EXPECT_THAT((*joints)[0].axis, ElementsAre(0, 0, 1));
  EXPECT_FALSE((*joints)[1].turns);
  EXPECT_THAT((*joints)[1].xyz, ElementsAre(0, 0, 0));
  EXPECT_EQ((*joints)[1].child, "tool0");
  EXPECT_EQ(ReadUrdf(Arm(), "arm.urdf", "l1", "tool0")->size(), 1U);
}

TEST(ReadUrdfTest, WhatIsNoneIsTold) {
  EXPECT_THAT(ErrorOf("links: []"), AllOf(HasSubstr("arm.urdf:1"), HasSubstr("expected a URDF")));
  EXPECT_THAT(ErrorOf(""), HasSubstr("expected a URDF"));
  EXPECT_THAT(ErrorOf("<sdf/>"), HasSubstr("found no element <robot>"));
  EXPECT_THAT(ErrorOf("<robot/>"), HasSubstr("found no joints"));
  EXPECT_THAT(ErrorOf(Arm("<xacro:arm/>")), AllOf(HasSubstr("arm.urdf:4: found macros"), HasSubstr("program xacro")));
  EXPECT_THAT(ErrorOf(Arm("<joint name=\"c\" type=\"fixed\"><parent link=\"l1\"/></joint>")),
              HasSubstr("arm.urdf:4: joint \"c\": expected a type, a parent and a child"));
}

std::string Third(const std::string& type, const std::string& more = "", const std::string& child = "hand") {
  return "<joint name=\"c\" type=\"" + type + "\"><parent link=\"tool0\"/><child link=\"" + child + "\"/>" + more +
         "</joint>\n";
}

TEST(ReadUrdfTest, WhatIsNoArmIsTold) {
  EXPECT_THAT(ErrorOf(Arm(), ""),
              AllOf(HasSubstr("found the links l1, tool0, expected which"), HasSubstr("tip: tool0")));
  EXPECT_THAT(ErrorOf(Arm(), "tool"), HasSubstr("tip: found \"tool\""));
  EXPECT_THAT(ErrorOf(Arm(), "tool0", "other"), HasSubstr("base: found \"other\""));
  EXPECT_THAT(ErrorOf(Arm(Third("prismatic")), "hand"), HasSubstr("arm.urdf:4: joint \"c\" is prismatic"));
  EXPECT_EQ(ErrorOf(Arm(Third("prismatic")), "tool0"), "");  // a gripper's
  EXPECT_THAT(ErrorOf(Arm(Third("revolute", "<mimic joint=\"a\"/>")), "hand"),
              HasSubstr("follows another one (mimic)"));
  EXPECT_THAT(ErrorOf(Arm(Third("revolute", "<axis xyz=\"0 0 0\"/>"))), HasSubstr("axis: found \"0 0 0\""));
  EXPECT_THAT(ErrorOf(Arm(Third("fixed", "<origin xyz=\"0 0\"/>"))), HasSubstr("xyz: found \"0 0\", expected three"));
  EXPECT_THAT(ErrorOf(Arm(Third("fixed", "<origin xyz=\"0 0 x\"/>"))), HasSubstr("expected three numbers"));
  EXPECT_THAT(ErrorOf(Arm(Third("fixed", "<origin xyz=\"0 0 0 0\"/>"))), HasSubstr("expected three numbers"));
  EXPECT_THAT(ErrorOf(Arm(Third("fixed", "", "l1"))), HasSubstr("\"l1\" hangs on two joints"));
  EXPECT_THAT(ErrorOf(Arm(Third("fixed", "", "base"))), HasSubstr("in a circle"));
}

}  // namespace
}  // namespace scancal
