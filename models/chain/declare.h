// What a dataset.yaml and its tables say of a robot's links and joints.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>
#include "io/dataset.h"
#include "io/json.h"
#include "io/table.h"
#include "models/chain/chain.h"
#include "models/chain/orientation.h"

namespace scancal {

// Reach of any robot, mm: outside of it the unit is another.
inline constexpr double kLeastReach_mm = 20, kLargestReach_mm = 20'000;

// robot: {coupled: {q3: q3 + q2}}: joint 3 turns by what q3 and q2 read together, as where q3 is counted from the
// horizontal.
struct Coupling {
  size_t joint = 0, with = 0;
  double times = 1;
};
std::string Said(const std::vector<Coupling>& couplings);  // " joint 3 turns by q3 + q2."; empty: none
std::vector<Coupling> ReadCouplings(YamlMap top, size_t joints);
// Joints as the controller shows them to those that turn the links.
std::vector<double> Uncoupled(const std::vector<double>& shown, const std::vector<Coupling>& couplings);

// What `robot:` says.
struct Arm {
  std::vector<Link> links;                              // nominal, base to flange; none without `robot:`
  Eigen::Vector3d gravity = -Eigen::Vector3d::UnitZ();  // its direction where the first link stands, a unit vector
  std::vector<Coupling> couplings;
  std::vector<double> gear_ratios;                                    // one a joint, 0: not known; none: of none
  std::vector<std::string> joints;                                    // their names in a URDF
  Eigen::Isometry3d base_from_first = Eigen::Isometry3d::Identity();  // of a URDF: where the first link stands
  std::filesystem::path urdf_file;
  std::string urdf;  // all that it says
};
// robot: {links: [{theta: 0, d: 333, a: 0, alpha: -90, beta: 0}, ...]}, in the data set's units, theta and beta 0 where
// they are not given; or robot: {urdf: arm.urdf, base: base_link, tip: tool0} (LinksOfUrdf; base: the root by default),
// which Dataset::urdf stands for. gravity: [0, 0, -1] is its direction in the base, of any length; down along z where
// it is not given. coupled: see Coupling. gear_ratio: [121, 121, 101, ...], turns of each motor for one of its joint, 0
// where nobody knows. Complains of units that no arm can have.
Result<Arm> ReadArm(const Dataset& dataset);

// calibration.json keeps the URDF, so that nothing else is needed to compute it again.
void KeepUrdf(const Arm& arm, Json* data);
Dataset WithUrdf(const Dataset& dataset, const Json& data);

// An Error for what is declared of the motors' turns without a gear ratio.
Result<void> CheckMotors(const InfluenceSetting& setting, const Arm& arm, const Dataset& dataset);

// parameters: {links: {estimate: 0, u_length: 0.5, u_angle: 0.1}}, in mm and rad.
struct LinkSetting {
  bool hold = false;                 // all of them; what is named singly stands
  double u_length = 0, u_angle = 0;  // of the prior of each that is estimated by default; 0: none
};
LinkSetting ReadLinkSetting(const Dataset& dataset);

// The parameters of a robot: its links as a whole, then each quantity that is named. links: how many; first_link: the
// index of theta_1; without_nominal: see SetDeclared.
Result<void> SetParameters(const Dataset& dataset, const LinkSetting& setting, size_t links, int first_link,
                           int without_nominal, std::span<Quantity> quantities);

// Noise that `influences:` declares: the quantities of that source are known (u), estimated, or none. every: what has
// it always ("ball"), which refuses none; else empty.
Result<void> SetNoise(const InfluenceSetting& setting, const Dataset& dataset, const std::string& every,
                      std::span<Quantity> quantities);

// What `influences:` says of something that all poses share: {estimate: 0, u: ...}, {consider: ...}, estimate, hold, or
// a standard uncertainty. Sets all quantities of that source.
Result<void> SetSystematic(const InfluenceSetting& setting, const Dataset& dataset, std::span<Quantity> quantities);

// The same for what the joints do, of one joint or of all: "gravity_2", "gravity". False: it is no such name. terms:
// those of DeclareJointTerms. known: their names are added, for a suggestion.
Result<bool> SetJointTerms(const InfluenceSetting& setting, const Dataset& dataset, std::span<Quantity> terms,
                           std::vector<std::string>* known);

// How a data set says where one of a robot's tables is and how it is written: `poses: poses.csv`, or with more,
// `poses: {file: poses.csv, columns: {q1: A1}, text: {decimal: ","}, where: {Robot: R1}, units: {angle: rad}}`. What
// stands at the top of the data set holds for all its tables; of `columns:` there each takes those that it has.
struct TableDeclaration {
  ScanFormat format;        // its path is empty where the data set has no such table
  Orientation orientation;  // of the turns in it
  bool names_orientation = false;
};
// columns: what the table may have, without turns. with_turns: `orientation:` may be declared.
TableDeclaration ReadTableDeclaration(YamlMap map, const std::string& key, const Dataset& dataset,
                                      const std::vector<TableColumn>& columns, bool with_turns = false);
// Complains of names in `columns:` at the top that none of these tables has.
void CheckColumnNames(YamlMap top, const std::vector<const TableDeclaration*>& tables);

// Joint angles in tables: columns q1 .. qn, and one too many, which CheckJoints refuses. remedy: see TableColumn.
std::vector<TableColumn> JointColumns(size_t joints, const std::string& remedy);

// Refuses more joints than there are links, angles beyond two turns, and angles that all lie within some degrees: they
// are of the other unit.
Result<void> CheckJoints(const Table& table, size_t joints);

// Of a row, rad; couplings: as declared.
std::vector<double> JointsOf(const Table& table, size_t row, size_t joints, const std::vector<Coupling>& couplings);

}  // namespace scancal
