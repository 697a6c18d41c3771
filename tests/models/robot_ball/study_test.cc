// The tables of scripts/robot_study with fewer data sets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include "tests/robot_study/configurations.h"
#include "tests/robot_study/efficiency.h"
#include "tests/robot_study/methods.h"

namespace scancal::robot_study {
namespace {

constexpr int kThreads = 2;

// Differences of the methods set by set, with their standard errors. Mu 2017 and Zhou 2025 tie: what the correction of
// the centres takes away says nothing of the robot.
TEST(RobotStudy, MethodsAreInTheOrderOfThePaper) {
  const std::vector<Method> methods = StudyMethods({}, 24, kThreads);
  ASSERT_GE(methods.size(), kOrdered);
  for (size_t k = 1; k < kOrdered; ++k) {
    const Mean gain = MeanOf(methods[k].mean - methods[k - 1].mean);
    EXPECT_LT(gain.value, (methods[k].name == "Zhou 2025" ? 3 : -1) * gain.u) << methods[k].name;
  }
}

TEST(RobotStudy, RefinementReachesTheBound) {
  robot_ball::Scene scene;
  scene.u_spheres = 0;
  for (const Noise noise : {Noise::kDeclared, Noise::kEstimated}) {
    const Efficiency e = StudyEfficiency(scene, noise, 80, kThreads);
    EXPECT_EQ(e.names.size(), 24);
    EXPECT_EQ(e.failed, 0);
    EXPECT_NEAR(e.ratio.mean(), 1, 4 * e.u_of_ratio);  // 0.022 from 80 runs
    // Standard error of one coverage: 0.024; of their mean below that.
    EXPECT_NEAR(e.coverage.mean(), 0.95, 0.03);
    EXPECT_GT(e.coverage.minCoeff(), 0.95 - 4 * 0.024);
    EXPECT_NEAR(e.width.mean(), 1, 0.05);
  }
}

TEST(RobotStudy, WhatJointsDoBesidesIsEstimatedAsWellAsCanBe) {
  robot_ball::Scene exact;
  exact.u_spheres = 0;
  for (const auto& [scene, noise] : {std::pair{WithRotation(exact), Noise::kEstimated},
                                     {WithGravity(exact), Noise::kDeclared},
                                     {WithBacklash(exact), Noise::kDeclared}}) {
    const Efficiency e = StudyEfficiency(scene, noise, 60, kThreads);
    EXPECT_EQ(e.failed, 0);
    EXPECT_NEAR(e.ratio.mean(), 1, 4 * e.u_of_ratio);
    EXPECT_NEAR(e.coverage.mean(), 0.95, 0.03);
    EXPECT_NEAR(e.width.mean(), 1, 0.07);
  }
}

TEST(RobotStudy, SpatialPosesAreBestCollinearOnesWorst) {
  const std::vector<Reconstruction> results = StudyConfigurations({}, 60, kThreads);
  ASSERT_EQ(results.size(), 3);
  EXPECT_LT(results[1].Error(0.5), results[0].Error(0.5));
  EXPECT_LT(results[2].Error(0.5), results[1].Error(0.5));
}

}  // namespace
}  // namespace scancal::robot_study
