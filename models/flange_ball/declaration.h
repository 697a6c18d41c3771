// What dataset.yaml declares of a robot with a ball on its flange.
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>
#include "io/dataset.h"
#include "models/flange_ball.h"
#include "models/flange_ball/joint_table.h"

namespace scancal {

struct ToolDeclaration {  // one location of the tool
  std::string name;
  std::array<std::filesystem::path, 2> sockets;  // joint angles with the ball in socket 0, in socket 1
};

struct FlangeBallDeclaration {
  Dataset dataset;
  FlangeBall model{{}};  // roles, values and u as declared
  JointFormat format;
  std::vector<ToolDeclaration> targets, check;  // check: not used in the calibration
  std::vector<std::filesystem::path> Files() const;
};

// Takes every key of the data set:
//
//     robot: {links: [...]}           nominal, base to flange
//     columns: [q1_rad, q2_rad, ...]  of joint files without a header
//     targets: [{name: front, sockets: [front/hole_0.csv, front/hole_1.csv]}, ...]
//     check: [...]                    further ones, held out
//     parameters: {spacing: {consider: 50, u: 0.05}, links: {estimate: 0, u_length: 1, u_angle: 1}, theta_6: hold}
//     influences: {seat: estimate, joints: 0.01}
Result<FlangeBallDeclaration> DeclareFlangeBall(const Dataset& dataset);

// The joint angles of its files.
Result<FlangeBall::Target> ReadTool(const ToolDeclaration& tool, const FlangeBallDeclaration& declaration);

}  // namespace scancal
