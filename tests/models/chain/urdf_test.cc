// Links of a URDF and a URDF of links say the same of every pose.
#include "models/chain/urdf.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>
#include "io/units.h"
#include "solver/random.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kQuarter = std::numbers::pi / 2;

// A joint as a URDF has it, its turns in rad.
std::string Joint(int number, const std::string& type, const std::string& xyz, const std::string& rpy,
                  const std::string& axis) {
  const std::string k = std::to_string(number), before = std::to_string(number - 1);
  return "<link name=\"l" + k + "\"/><joint name=\"j" + k + "\" type=\"" + type + "\"><parent link=\"l" + before +
         "\"/><child link=\"l" + k + "\"/><origin xyz=\"" + xyz + "\" rpy=\"" + rpy + "\"/>" +
         (axis.empty() ? "" : "<axis xyz=\"" + axis + "\"/>") + "</joint>\n";
}

// As the makers of a UR10 write it: axes along y, three of them parallel, fixed joints at both ends.
std::string Ur10() {
  const std::string quarter = "1.5707963267948966";
  return "<?xml version=\"1.0\"?>\n<robot name=\"ur10\">\n" +
         Joint(1, "fixed", "0 0 0.01", "0 0 3.141592653589793", "") +
         Joint(2, "revolute", "0 0 0.1273", "0 0 0", "0 0 1") +
         Joint(3, "revolute", "0 0.220941 0", "0 " + quarter + " 0", "0 1 0") +
         Joint(4, "revolute", "0 -0.1719 0.612", "0 0 0", "0 1 0") +
         Joint(5, "revolute", "0 0 0.5723", "0 " + quarter + " 0", "0 1 0") +
         Joint(6, "revolute", "0 0.1149 0", "0 0 0", "0 0 1") + Joint(7, "revolute", "0 0 0.1157", "0 0 0", "0 1 0") +
         Joint(8, "fixed", "0 0.0922 0", "-" + quarter + " 0 0", "") + "</robot>\n";
}

std::vector<UrdfJoint> Read(const std::string& text, const std::string& tip = "l8") {
  auto joints = ReadUrdf(text, "arm.urdf", "", tip);
  EXPECT_TRUE(joints.ok()) << joints.error().message;
  return joints.ok() ? *std::move(joints) : std::vector<UrdfJoint>();
}

std::vector<double> Angles(size_t count, Random* random) {
  std::vector<double> angles(count);
  for (double& q : angles) q = 6 * random->Uniform() - 3;
  return angles;
}

// The largest difference of the two over some poses, mm or 1.
double Apart(const UrdfLinks& arm, const std::vector<UrdfJoint>& joints) {
  Random random(1, 0);
  double apart = 0;
  for (int pose = 0; pose < 20; ++pose) {
    const std::vector<double> q = Angles(arm.links.size(), &random);
    apart = std::max(apart,
                     ((arm.base_from_first * BaseFromFlange(arm.links, q)).matrix() - BaseFromTip(joints, q).matrix())
                         .cwiseAbs()
                         .maxCoeff());
  }
  return apart;
}

TEST(UrdfTest, LinksOfAnArmWithParallelAxes) {
  const std::vector<UrdfJoint> joints = Read(Ur10());
  const auto arm = LinksOfUrdf(joints, "arm.urdf");
  ASSERT_TRUE(arm.ok()) << arm.error().message;
  EXPECT_THAT(arm->joints, ElementsAre("j2", "j3", "j4", "j5", "j6", "j7"));
  ASSERT_EQ(arm->links.size(), 6U);
  EXPECT_LT(Apart(*arm, joints), 1e-9);
  EXPECT_TRUE(arm->base_from_first.matrix().isIdentity(0));
  EXPECT_NEAR(arm->links[0].d, 137.3, 1e-9);
  EXPECT_NEAR(std::abs(arm->links[1].a), 612, 1e-9);
  EXPECT_EQ(arm->links[1].d, 0);
  EXPECT_EQ(arm->links[2].d, 0);
  EXPECT_NEAR(std::abs(arm->links[3].d), 220.941 - 171.9 + 114.9, 1e-9);
  EXPECT_NEAR(std::abs(arm->links[5].d), 92.2, 1e-9);
}

// Any chain of axes, skew, nearly parallel, of a base that lies on its side.
TEST(UrdfTest, LinksOfAnyAxes) {
  Random random(2, 0);
  for (int arm = 0; arm < 20; ++arm) {
    std::vector<UrdfJoint> joints(8);
    size_t turning = 0;
    for (size_t k = 0; k < joints.size(); ++k) {
      joints[k].turns = k != 3 && k + 1 < joints.size();
      turning += joints[k].turns ? 1 : 0;
      for (double& x : joints[k].xyz) x = random.Uniform() - 0.5;
      for (double& x : joints[k].rpy) x = 6 * random.Uniform() - 3;
      for (double& x : joints[k].axis) x = random.Uniform() - 0.5;
      if (k == 5)
        joints[k].rpy = {1e-5 * random.Uniform(), 1e-5 * random.Uniform(), 2}, joints[k].axis = joints[4].axis;
    }
    joints[7].xyz = joints[6].axis;  // on the axis of the last
    const auto links = LinksOfUrdf(joints, "arm.urdf");
    ASSERT_TRUE(links.ok()) << links.error().message;
    ASSERT_EQ(links->links.size(), turning);
    EXPECT_LT(Apart(*links, joints), 1e-9) << "arm " << arm;
  }
}

// A calibrated arm, written and read again, moves as before.
TEST(UrdfTest, WhatIsWrittenMovesAsTheChain) {
  const auto nominal = LinksOfUrdf(Read(Ur10()), "arm.urdf");
  ASSERT_TRUE(nominal.ok());
  UrdfLinks arm = *nominal;
  Random random(3, 0);
  for (Link& link : arm.links) {
    for (double* angle : {&link.theta, &link.alpha, &link.beta}) *angle += 0.01 * random.Normal();
    for (double* length : {&link.d, &link.a}) *length += random.Normal();
  }
  arm.links[2].beta = kQuarter;  // roll and yaw are one there
  arm.base_from_first.linear() = Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
  tool.linear() = Eigen::AngleAxisd(-2, Eigen::Vector3d(3, -2, 1).normalized()).toRotationMatrix();
  tool.translation() << 10, -20, 130;
  const std::string text = UrdfOf("Arm <1> & \"two\"", arm, {{"tool", tool}}, {"gravity -- left out"});
  const std::vector<UrdfJoint> flange = Read(text, "flange"), with_tool = Read(text, "tool");
  EXPECT_EQ(flange[0].name, "j2");
  EXPECT_LT(Apart(arm, flange), 1e-9);
  const std::vector<double> q = Angles(6, &random);
  EXPECT_LT((BaseFromTip(with_tool, q).matrix() - (BaseFromTip(flange, q) * tool).matrix()).cwiseAbs().maxCoeff(),
            1e-9);
}

TEST(UrdfTest, ATipThatNoLinkHolds) {
  std::vector<UrdfJoint> joints = Read(Ur10());
  joints.back().xyz = {0.1, 0.1, 0.1};
  joints.back().rpy = {0.3, 0.2, 0.1};
  EXPECT_THAT(LinksOfUrdf(joints, "arm.urdf").error().message,
              AllOf(HasSubstr("arm.urdf: the frame of \"l8\" lies off the last axis"), HasSubstr("tip: tool0")));
  EXPECT_THAT(LinksOfUrdf({joints.back()}, "arm.urdf").error().message, HasSubstr("no joint that turns"));
}

}  // namespace
}  // namespace scancal
