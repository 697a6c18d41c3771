// The robot with a ball on its flange as a Scanner, and what its dataset.yaml declares.
#pragma once
#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>
#include "io/result.h"
#include "models/chain/declare.h"
#include "models/flange_ball.h"
#include "models/scanner.h"
#include "solver/calibrate.h"

namespace scancal::flange_ball {

struct Robot {
  std::vector<Link> links;
  Eigen::Vector3d ball = Eigen::Vector3d::Zero();  // in the flange's frame
  std::vector<double> joint_terms = {};            // of DeclareJointTerms; none: zero
  Eigen::Isometry3d FlangeAt(const Model::View& pose) const {
    return BaseFromFlange(links, TurnedJoints(pose.joints, pose.terms, joint_terms));
  }
  Eigen::Vector3d InBase(const Model::View& pose) const { return FlangeAt(pose) * ball; }
  // Of a pose's socket: the mean over all poses in it.
  Eigen::Vector3d Socket(const Model::Target& tool, int socket) const;
};

// The links as they are, the ball by linear least squares: it shall stay where it is in each socket of each tool.
// For a robot whose last axis never turns one coordinate is arbitrary.
Robot FitBall(const std::vector<Link>& links, const std::vector<Model::Target>& tools);

// Sets the terms of all poses of a tool; those of a socket were taken one after the other, in the order of its file.
void SetTerms(const Arm& arm, Model::Target* tool);

// What a robot says of a tool, whether it was calibrated with it or not. Nothing is fitted.
struct Seating {
  double spread = 0;   // mean over the poses of |ball - its socket|, mm
  double spacing = 0;  // of the two sockets, mm
};
Seating SeatingOf(const Robot& robot, const Model::Target& tool);

// The joint fit of links, ball and sockets with equal weights, from what FitBall says of the model's nominal links. An
// Error names what these locations do not determine.
Result<Solution> FitJointly(const Model& model, std::vector<Model::Target> tools, int max_iterations = 100);

Robot RobotOf(const std::vector<Link>& nominal, const Solution& solution);

struct ToolDeclaration {  // one location of the tool
  std::string name;
  std::array<std::filesystem::path, 2> sockets;  // joint angles with the ball in socket 0, in socket 1
  ScanFormat format = {};                        // of both
};

struct Declaration {
  Dataset dataset;
  Model model{{}};  // roles, values and u as declared
  Arm arm;
  std::vector<ToolDeclaration> targets, check;  // check: not used in the calibration
  std::vector<std::filesystem::path> Files() const;
};

// Takes every key of the data set:
//
//     robot: {links: [...]}           nominal, base to flange
//     columns: [q1_rad, q2_rad, ...]  of joint files without a header, or {q1: A1} of other names; text, where: as
//                                     of scans; all of them for all files, or in one target
//     targets: [{name: front, sockets: [front/hole_0.csv, front/hole_1.csv]}, ...]
//     check: [...]                    further ones, held out
//     parameters: {spacing: {consider: 50, u: 0.05}, links: {estimate: 0, u_length: 1, u_angle: 1}, theta_6: hold}
//     influences: {seat: estimate, joints: 0.01}
Result<Declaration> Declare(const Dataset& dataset);

// The joint angles of its files, two poses or more in each.
Result<Model::Target> ReadTool(const ToolDeclaration& tool, const Declaration& declaration);

class Scanner final : public scancal::Scanner {
 public:
  // targets, check: in the order of the declaration.
  Scanner(Declaration declaration, std::vector<Model::Target> targets, std::vector<Model::Target> check);
  std::string Describe() const override;
  const Dataset& dataset() const override { return declaration_.dataset; }
  std::vector<std::filesystem::path> Files() const override;
  Result<Json> Data() const override;
  Result<Calibration> Calibrate(const RefineChoice& choice) const override;
  // The nominal robot, of which only the ball is fitted, and the refined one: how far the ball strays in its sockets,
  // where the tool was calibrated with and where it was held out.
  Result<Comparison> Compare(const CompareChoice& choice) const override;

 private:
  double Spacing() const;  // as declared, mm
  Result<Solution> Fit(const RefineChoice& choice) const;

  Declaration declaration_;
  std::vector<Model::Target> targets_, check_;
};

Result<std::unique_ptr<scancal::Scanner>> Load(const Dataset& dataset);
Result<std::unique_ptr<scancal::Scanner>> Reload(const Dataset& dataset, const Json& data, const std::string& file);
// The ball of every pose in the base, held out ones as well; a scan is a location of the tool.
Result<int64_t> Transform(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud);

inline constexpr ScannerKind kKind = {"flange-ball", &Load, &Reload, &Transform};

}  // namespace scancal::flange_ball
